#include "testbench/scene/mesh.hpp"

#include <algorithm>
#include <cmath>

namespace testbench {

bool is_degenerate(const Triangle& triangle) {
  const glm::dvec3 edges[3] = {triangle.vertex[1] - triangle.vertex[0],
                               triangle.vertex[2] - triangle.vertex[1],
                               triangle.vertex[0] - triangle.vertex[2]};
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
