#include "testbench/bvh/bvh.hpp"

namespace testbench {

double Box::half_area() const {
  const glm::dvec3 size = upper - lower;
  if (glm::any(glm::lessThan(size, glm::dvec3(0.0)))) return 0.0;
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

Box bounds_of(const Triangle& triangle) {
  Box box;
  for (const glm::dvec3& vertex : triangle.vertex) box.include(vertex);
  return box;
}

Box BvhNode::box() const {
  Box all;
  for (int i = 0; i < child_count; ++i) all.include(child[std::size_t(i)].box);
  return all;
}

}  // namespace testbench
