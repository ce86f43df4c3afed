#pragma once

#include <optional>

#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// Rays of the host among a scene's triangles. The firmware's rays are more careful at edges and in planes
/// that coincide; these serve estimates.
class SceneRays {
 public:
  explicit SceneRays(const std::vector<Triangle>& triangles);

  struct Hit {
    std::size_t triangle;
    double distance;  ///< in lengths of the direction
  };
  /// The first triangle along the ray, from either side.
  std::optional<Hit> nearest(const glm::dvec3& origin, const glm::dvec3& direction) const;
  /// Whether a triangle lies nearer than the distance.
  bool is_blocked(const glm::dvec3& origin, const glm::dvec3& direction, double distance) const;

 private:
  template <class Take>
  void visit(const glm::dvec3& origin, const glm::dvec3& direction, double& farthest, const Take& take) const;

  const std::vector<Triangle>& triangles_;
  Bvh bvh_;
};

}  // namespace testbench
