#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/traversal_record.hpp"
#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// A tree in the layout that the firmware reads.
struct TreeImage {
  std::vector<std::uint8_t> nodes;  ///< slot by slot
  std::int64_t slots = 0;
  std::vector<std::int32_t> triangles;  ///< indices into the scene's triangles, leaf by leaf
  int levels = 0;
};

/// Builds a tree over boxes and cuts it into treelets of the given shape.
/// @throws InputError if it has more nodes or triangles than a reference can address, RunError if it has more
/// levels than a ray can keep track of
TreeImage make_tree_image(const std::vector<Box>& boxes, const path_tracer::TreeShape& shape);

}  // namespace testbench
