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

bool is_point_in_range(const glm::dvec3& point) {
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(point[axis]) <= kMaxCoordinate)) return false;
  return true;
}

bool is_in_range(const Triangle& triangle) {
  return is_point_in_range(triangle.vertex[0]) && is_point_in_range(triangle.vertex[1]) &&
         is_point_in_range(triangle.vertex[2]);
}

void keep_used_textures(Scene& scene) {
  std::vector<std::int32_t> new_index(scene.textures.size(), kNoTexture);
  std::array<bool, kTextureCoordinateSets> is_used_set{};
  bool has_normal_texture = false;
  std::vector<Texture> used;
  for (Material& material : scene.materials) {
    drop_idle_textures(material);
    has_normal_texture = has_normal_texture || material.textures.normal;
    for_each_texture(material.textures, [&](TextureReference& reference) {
      if (!reference) return;
      is_used_set[std::size_t(reference.coordinate_set)] = true;
      std::int32_t& index = new_index[std::size_t(reference.texture)];
      if (index == kNoTexture) {
        index = static_cast<std::int32_t>(used.size());
        used.push_back(std::move(scene.textures[std::size_t(reference.texture)]));
      }
      reference.texture = index;
    });
  }
  scene.textures = std::move(used);
  for (std::size_t set = 0; set < is_used_set.size(); ++set)
    if (!is_used_set[set]) scene.corners.coordinates[set] = {};
  if (!has_normal_texture) scene.corners.tangents = {};
}

std::size_t ColourMaterials::Hash::operator()(const glm::dvec4& colour) const {
  const std::hash<double> hash;
  return (hash(colour.x) * 0x9e3779b97f4a7c15u) ^ (hash(colour.y) * 0xc2b2ae3d27d4eb4fu) ^
         (hash(colour.z) * 0x165667b19e3779f9u) ^ (hash(colour.w) * 0x27d4eb2f165667c5u);
}

std::int32_t ColourMaterials::index_of(const glm::dvec4& colour, const Material& plain) {
  const auto [entry, is_new] = index_of_.emplace(colour, static_cast<std::int32_t>(materials_.size()));
  if (!is_new) return entry->second;
  Material material = plain;
  material.name = "colour" + std::to_string(index_of_.size());
  material.reflectance = glm::dvec3(colour);
  material.alpha = colour.a;
  if (plain.transmission_colour == plain.reflectance) material.transmission_colour = material.reflectance;
  materials_.push_back(std::move(material));
  return entry->second;
}

void MeshBuilder::add_triangle(const Triangle& triangle, const PolygonAttributes& attributes,
                               const std::array<std::uint32_t, 3>& corners) {
  if (is_degenerate(triangle)) {
    ++mesh_.degenerate_triangles;
    return;
  }
  TriangleAttributes of_triangle;
  if (!attributes.normals.empty())
    of_triangle.normals = corner_normals(
        triangle.vertex,
        {attributes.normals[corners[0]], attributes.normals[corners[1]], attributes.normals[corners[2]]});
  for (std::size_t set = 0; set < attributes.coordinates.size(); ++set)
    if (const std::vector<glm::dvec2>& all = attributes.coordinates[set]; !all.empty())
      of_triangle.coordinates[set] = corner_coordinates({all[corners[0]], all[corners[1]], all[corners[2]]});
  set_corner_attributes(mesh_.corners, mesh_.triangles.size(), of_triangle);
  mesh_.triangles.push_back(triangle);
}

void require_triangles(const Mesh& mesh, const std::filesystem::path& file) {
  if (!mesh.triangles.empty()) return;
  throw InputError(file.string() + ": found no triangle (" + std::to_string(mesh.degenerate_triangles) +
                   " without area); allowed: a mesh of one triangle or more");
}

void keep_used_materials(const std::vector<Material>& all, Mesh& mesh) {
  const std::vector<bool> is_used = materials_in_use(mesh.triangles, all.size());
  std::vector<std::int32_t> new_index(all.size());
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!is_used[i]) continue;
    new_index[i] = static_cast<std::int32_t>(mesh.materials.size());
    mesh.materials.push_back(all[i]);
  }
  for (Triangle& triangle : mesh.triangles) {
    triangle.material = new_index[static_cast<std::size_t>(triangle.material)];
  }
}

}  // namespace testbench
