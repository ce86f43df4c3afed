#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/traversal_record.hpp"
#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// A tree as the firmware wants it.
struct TreeImage {
  std::vector<std::uint8_t> nodes;  ///< slot by slot
  std::int64_t slots = 0;
  std::vector<std::int32_t> triangles;  ///< the scene's, leaf by leaf
  int levels = 0;
};

/// Builds a tree over boxes, cut into treelets of the given shape.
/// @throws InputError when it has more nodes or triangles than a reference can name, RunError when it is
/// deeper than a ray can follow
TreeImage make_tree_image(const std::vector<Box>& boxes, const path_tracer::TreeShape& shape);

}  // namespace testbench
