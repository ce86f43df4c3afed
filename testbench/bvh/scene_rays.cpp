#include "testbench/bvh/scene_rays.hpp"

#include <cmath>
#include <limits>

#include "testbench/bvh/balanced_bvh.hpp"

namespace testbench {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();

std::vector<Box> boxes_of(const std::vector<Triangle>& triangles) {
  std::vector<Box> boxes;
  boxes.reserve(triangles.size());
  for (const Triangle& triangle : triangles) boxes.push_back(bounds_of(triangle));
  return boxes;
}

/// Distance along the ray, or infinity (Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle
/// Intersection", 1997).
double meet(const Triangle& triangle, const glm::dvec3& origin, const glm::dvec3& direction) {
  const glm::dvec3 edge1 = triangle.vertex[1] - triangle.vertex[0];
  const glm::dvec3 edge2 = triangle.vertex[2] - triangle.vertex[0];
  const glm::dvec3 p = glm::cross(direction, edge2);
  const double inverse = 1.0 / glm::dot(edge1, p);
  const glm::dvec3 from = origin - triangle.vertex[0];
  const double u = glm::dot(from, p) * inverse;
  const glm::dvec3 q = glm::cross(from, edge1);
  const double v = glm::dot(direction, q) * inverse;
  const double distance = glm::dot(edge2, q) * inverse;
  return u >= 0 && v >= 0 && u + v <= 1 && distance > 0 ? distance : kNever;
}

/// Where the ray enters the box, or infinity. Boxes are widened by a few roundings.
double enter(const Box& box, const glm::dvec3& origin, const glm::dvec3& inverse_direction, double farthest) {
  constexpr double kWiden = 1.0 + 0x1p-48;
  double first = 0.0;
  double last = farthest;
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = (box.lower[axis] - origin[axis]) * inverse_direction[axis];
    const double upper = (box.upper[axis] - origin[axis]) * inverse_direction[axis];
    // Comparisons with NaN, of a ray within a side's plane, keep what was known before.
    const double near = lower < upper ? lower : upper;
    const double far = (lower < upper ? upper : lower) * kWiden;
    if (near > first) first = near;
    if (far < last) last = far;
  }
  return first <= last * kWiden ? first : kNever;
}

}  // namespace

SceneRays::SceneRays(const std::vector<Triangle>& triangles)
    : triangles_(triangles), bvh_(build_balanced_bvh(boxes_of(triangles), 2, 4)) {}

/// Calls `take` for each triangle that is met nearer than `farthest`, which it may lower.
template <class Take>
void SceneRays::visit(const glm::dvec3& origin, const glm::dvec3& direction, double& farthest,
                      const Take& take) const {
  if (bvh_.nodes.empty()) return;
  const glm::dvec3 inverse = 1.0 / direction;
  struct Entry {
    std::int32_t node;
    double distance;
  };
  constexpr int kMostLevels = 64;  // a balanced tree of 2^31 triangles has 31
  Entry stack[kMostLevels];
  int waiting = 0;
  stack[waiting++] = {0, 0.0};
  while (waiting > 0) {
    const Entry entry = stack[--waiting];
    if (!(entry.distance < farthest)) continue;
    const BvhNode& node = bvh_.nodes[std::size_t(entry.node)];
    const int first_entry = waiting;
    for (int i = 0; i < node.child_count; ++i) {
      const BvhChild& child = node.child[std::size_t(i)];
      const double distance = enter(child.box, origin, inverse, farthest);
      if (!(distance < farthest)) continue;
      if (!child.is_leaf()) {
        stack[waiting++] = {child.node, distance};
        continue;
      }
      for (std::int32_t t = 0; t < child.triangle_count; ++t) {
        const auto index = std::size_t(bvh_.triangles[std::size_t(child.first_triangle + t)]);
        const double met = meet(triangles_[index], origin, direction);
        if (met < farthest) take(index, met);
      }
    }
    if (waiting - first_entry == 2 && stack[first_entry].distance < stack[first_entry + 1].distance)
      std::swap(stack[first_entry], stack[first_entry + 1]);
  }
}

std::optional<SceneRays::Hit> SceneRays::nearest(const glm::dvec3& origin,
                                                 const glm::dvec3& direction) const {
  double farthest = kNever;
  std::optional<Hit> hit;
  visit(origin, direction, farthest, [&](std::size_t triangle, double distance) {
    farthest = distance;
    hit = Hit{triangle, distance};
  });
  return hit;
}

bool SceneRays::is_blocked(const glm::dvec3& origin, const glm::dvec3& direction, double distance) const {
  double farthest = distance;
  bool is_met = false;
  visit(origin, direction, farthest, [&](std::size_t, double) {
    is_met = true;
    farthest = 0.0;
  });
  return is_met;
}

}  // namespace testbench
