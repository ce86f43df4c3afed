#pragma once

#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// Builds a tree of minimal depth: it splits triangles into equal numbers, in the order of their centres
/// along the longest axis. It serves triangles that the surface area heuristic cannot separate, such as
/// hundreds of thousands in one place. The same boxes give the same tree.
///
/// @param width most children of a node, 2 to kMaxBvhWidth
/// @param max_leaf_triangles at least 1
Bvh build_balanced_bvh(const std::vector<Box>& boxes, int width, int max_leaf_triangles);

}  // namespace testbench
