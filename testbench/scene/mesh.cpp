#include "testbench/scene/mesh.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

#include "testbench/system/error.hpp"

namespace testbench {

bool is_degenerate(const Triangle& triangle) {
  glm::dvec3 edges[3] = {triangle.vertex[1] - triangle.vertex[0], triangle.vertex[2] - triangle.vertex[1],
                         triangle.vertex[0] - triangle.vertex[2]};
  double largest = 0.0;
  for (const glm::dvec3& edge : edges)
    largest = std::max({largest, std::abs(edge.x), std::abs(edge.y), std::abs(edge.z)});
  // Fourth powers of lengths beyond these vanish or overflow; a power of two changes no digit.
  if ((largest < 1e-70 || largest > 1e70) && largest > 0.0)
    for (glm::dvec3& edge : edges) edge *= std::ldexp(1.0, -std::max(std::ilogb(largest), -1000));
  const double longest = std::max({glm::length(edges[0]), glm::length(edges[1]), glm::length(edges[2])});
  const double height_times_longest = glm::length(glm::cross(edges[0], edges[1]));
  return !(height_times_longest > 1e-12 * longest * longest);
}

bool is_in_range(const Triangle& triangle) {
  for (const glm::dvec3& vertex : triangle.vertex) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(std::abs(vertex[axis]) <= kMaxCoordinate)) return false;
    }
  }
  return true;
}

std::size_t ColourMaterials::Hash::operator()(const glm::dvec3& colour) const {
  const std::hash<double> hash;
  return (hash(colour.x) * 0x9e3779b97f4a7c15u) ^ (hash(colour.y) * 0xc2b2ae3d27d4eb4fu) ^
         (hash(colour.z) * 0x165667b19e3779f9u);
}

std::int32_t ColourMaterials::index_of(const glm::dvec3& reflectance, const glm::dvec3& emission) {
  const auto [entry, is_new] = index_of_.emplace(reflectance, static_cast<std::int32_t>(materials_.size()));
  if (is_new) materials_.push_back({"colour" + std::to_string(index_of_.size()), reflectance, emission});
  return entry->second;
}

void require_triangles(const Mesh& mesh, const std::filesystem::path& file) {
  if (!mesh.triangles.empty()) return;
  throw InputError(file.string() + ": found no triangle (" + std::to_string(mesh.degenerate_triangles) +
                   " without area); allowed: a mesh of one triangle or more");
}

bool is_reflectance(const glm::dvec3& colour) {
  for (int channel = 0; channel < 3; ++channel)
    if (!(colour[channel] >= 0.0 && colour[channel] <= 1.0)) return false;
  return true;
}

void keep_used_materials(const std::vector<Material>& all, Mesh& mesh) {
  std::vector<std::int32_t> new_index(all.size(), -1);
  for (const Triangle& triangle : mesh.triangles) new_index[static_cast<std::size_t>(triangle.material)] = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (new_index[i] < 0) continue;
    new_index[i] = static_cast<std::int32_t>(mesh.materials.size());
    mesh.materials.push_back(all[i]);
  }
  for (Triangle& triangle : mesh.triangles) {
    triangle.material = new_index[static_cast<std::size_t>(triangle.material)];
  }
}

}  // namespace testbench
