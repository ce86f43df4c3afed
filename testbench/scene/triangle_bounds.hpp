#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The box of triangles, parallel to the axes.
struct TriangleBounds {
  glm::dvec3 lower{0.0};
  glm::dvec3 upper{0.0};

  glm::dvec3 sides() const { return upper - lower; }
  glm::dvec3 middle() const { return lower + sides() / 2.0; }
};

/// A box at the origin without extent if there are none.
inline TriangleBounds bounds_of(const std::vector<Triangle>& triangles) {
  if (triangles.empty()) return {};
  TriangleBounds bounds{triangles[0].vertex[0], triangles[0].vertex[0]};
  for (const Triangle& triangle : triangles)
    for (const glm::dvec3& vertex : triangle.vertex) {
      bounds.lower = glm::min(bounds.lower, vertex);
      bounds.upper = glm::max(bounds.upper, vertex);
    }
  return bounds;
}

}  // namespace testbench
