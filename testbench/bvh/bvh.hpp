#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Closed and aligned to the axes; empty until something is put into it.
struct Box {
  glm::dvec3 lower{std::numeric_limits<double>::infinity()};
  glm::dvec3 upper{-std::numeric_limits<double>::infinity()};

  void include(const glm::dvec3& point) {
    lower = glm::min(lower, point);
    upper = glm::max(upper, point);
  }
  void include(const Box& box) {
    lower = glm::min(lower, box.lower);
    upper = glm::max(upper, box.upper);
  }
  bool contains(const Box& box) const {
    return glm::all(glm::lessThanEqual(lower, box.lower)) &&
           glm::all(glm::greaterThanEqual(upper, box.upper));
  }
  /// Half of the surface area; 0 when empty.
  double half_area() const;
};

Box bounds_of(const Triangle& triangle);

inline constexpr int kMaxBvhWidth = 8;

/// One child of a node: another node, or a run of triangles.
struct BvhChild {
  Box box;                          ///< exact: the smallest around all that is below
  std::int32_t node = -1;           ///< index into Bvh::nodes; -1 for a leaf
  std::int32_t first_triangle = 0;  ///< of a leaf: index into Bvh::triangles
  std::int32_t triangle_count = 0;

  bool is_leaf() const { return node < 0; }
};

struct BvhNode {
  int child_count = 0;
  std::array<BvhChild, kMaxBvhWidth> child;

  Box box() const;  ///< around all that is below
};

/// A tree of boxes over a scene's triangles. Nodes stand before their children; nodes[0] is the root. Of no
/// triangles: no nodes.
struct Bvh {
  int width = 2;
  std::vector<BvhNode> nodes;
  std::vector<std::int32_t> triangles;  ///< indices into the scene's, leaf by leaf, each once
};

}  // namespace testbench
