#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// A closed box aligned to the axes; empty until include() is called.
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
  /// Half of the surface area; 0 for an empty box.
  double half_area() const;
};

Box bounds_of(const Triangle& triangle);

inline constexpr int kMaxBvhWidth = 8;

/// One child of a node: another node, or a leaf, which is a range of triangles.
struct BvhChild {
  Box box;                          ///< the smallest box around all triangles below
  std::int32_t node = -1;           ///< index into Bvh::nodes; -1 for a leaf
  std::int32_t first_triangle = 0;  ///< only in a leaf: index into Bvh::triangles
  std::int32_t triangle_count = 0;

  bool is_leaf() const { return node < 0; }
};

struct BvhNode {
  int child_count = 0;
  std::array<BvhChild, kMaxBvhWidth> child;

  Box box() const;  ///< the smallest box around all triangles below
};

/// A tree of boxes over a scene's triangles. Nodes precede their children; nodes[0] is the root. A tree of no
/// triangles has no nodes.
struct Bvh {
  int width = 2;
  std::vector<BvhNode> nodes;
  std::vector<std::int32_t> triangles;  ///< indices into the scene's triangles, leaf by leaf, each once
};

}  // namespace testbench
