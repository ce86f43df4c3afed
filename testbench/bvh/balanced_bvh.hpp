#pragma once

#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// A tree of the least depth: triangles are split by number, in the order of their centres along the longest
/// axis. For those that the surface area heuristic cannot tell apart, as hundreds of thousands in one place.
/// The same boxes give the same tree.
///
/// @param width children a node, 2 to kMaxBvhWidth
/// @param max_leaf_triangles at least 1
Bvh build_balanced_bvh(const std::vector<Box>& boxes, int width, int max_leaf_triangles);

}  // namespace testbench
