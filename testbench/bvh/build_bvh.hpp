#pragma once

#include "testbench/bvh/bvh.hpp"

namespace testbench {

struct BvhOptions {
  int width = 4;                ///< children a node, 2 to kMaxBvhWidth
  int max_leaf_triangles = 4;   ///< 1 to 30
  int max_depth = 64;           ///< levels of nodes; splits are by number when it comes near, at least 16
  double traversal_cost = 1.0;  ///< of a node, in units of intersection_cost for a triangle
  double intersection_cost = 1.0;
};

/// A tree by the surface area heuristic, split at binned centroids (Wald, "On fast Construction of SAH-based
/// Bounding Volume Hierarchies", IRT 2007). Embree splits and joins nodes to the width; boxes are made again,
/// in double precision. The same triangles give the same tree.
/// A million triangles take about two seconds, so there is no way to interrupt it. Where this way would go
/// too deep, a balanced tree (balanced_bvh.hpp).
///
/// @throws InputError for options out of range, RunError when no tree of so few levels holds all triangles
Bvh build_bvh(const std::vector<Triangle>& triangles, const BvhOptions& options);

/// The same of the triangles' boxes.
Bvh build_bvh(const std::vector<Box>& boxes, const BvhOptions& options);

/// How many levels of nodes there are.
int levels(const Bvh& bvh);

/// What the heuristic expects a ray that meets the root's box to cost.
double sah_cost(const Bvh& bvh, const BvhOptions& options);

}  // namespace testbench
