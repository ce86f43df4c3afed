#pragma once

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The barycentric coordinates of a point p in a triangle's plane: u = to_u . (p - vertex[0]) is 1 at
/// vertex[1] and 0 at the others, v = to_v . (p - vertex[0]) is 1 at vertex[2].
struct Barycentric {
  glm::dvec3 to_u;
  glm::dvec3 to_v;

  explicit Barycentric(const Triangle& triangle) {
    const glm::dvec3 edge1 = triangle.vertex[1] - triangle.vertex[0];
    const glm::dvec3 edge2 = triangle.vertex[2] - triangle.vertex[0];
    const glm::dvec3 plane = glm::cross(edge1, edge2);
    const double area_squared = glm::dot(plane, plane);
    to_u = glm::cross(edge2, plane) / area_squared;
    to_v = glm::cross(plane, edge1) / area_squared;
  }
};

}  // namespace testbench
