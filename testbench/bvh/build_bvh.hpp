#pragma once

#include "testbench/bvh/bvh.hpp"

namespace testbench {

struct BvhOptions {
  int width = 4;                ///< most children of a node, 2 to kMaxBvhWidth
  int max_leaf_triangles = 4;   ///< 1 to 30
  int max_depth = 64;           ///< most levels of nodes, at least 16; near it, splits are by number
  double traversal_cost = 1.0;  ///< cost of a node, in the unit of intersection_cost
  double intersection_cost = 1.0;
};

/// Builds a tree by the surface area heuristic, with splits at binned centroids (Wald, "On fast Construction
/// of SAH-based Bounding Volume Hierarchies", IRT 2007). Embree splits nodes and joins them to the width; the
/// boxes are computed again in double precision. The same triangles give the same tree. If that tree would be
/// deeper than max_depth, a balanced tree is built instead (balanced_bvh.hpp). A million triangles take about
/// two seconds, so the build cannot be interrupted.
///
/// @throws InputError for options out of range, RunError if no tree of max_depth levels can hold all
/// triangles
Bvh build_bvh(const std::vector<Triangle>& triangles, const BvhOptions& options);

/// The same for the boxes of the triangles.
Bvh build_bvh(const std::vector<Box>& boxes, const BvhOptions& options);

/// The number of levels of nodes.
int levels(const Bvh& bvh);

/// The cost that the heuristic expects for a ray that meets the root's box.
double sah_cost(const Bvh& bvh, const BvhOptions& options);

}  // namespace testbench
