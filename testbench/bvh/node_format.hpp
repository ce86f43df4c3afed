#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/node_layout.hpp"
#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// Writes a node in the format that the chip reads. `slot_of_node` holds the slot of each node of the tree.
/// Unused children are marked as leading nowhere.
/// @param to room for layout.node_bytes() bytes
void encode_node(const BvhNode& node, const path_tracer::NodeLayout& layout,
                 const std::vector<std::int32_t>& slot_of_node, std::uint8_t* to);

/// The box that the chip decodes for a child of an encoded node, and the reference to that child.
Box decode_box(const std::uint8_t* node, const path_tracer::NodeLayout& layout, int child);
path_tracer::ChildReference decode_reference(const std::uint8_t* node, const path_tracer::NodeLayout& layout,
                                             int child);

}  // namespace testbench
