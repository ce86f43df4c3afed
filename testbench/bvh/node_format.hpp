#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/node_layout.hpp"
#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// Writes a node as the chip reads it; `slot_of_node` gives the slot of each node of the tree. Children that
/// the node does not have lead nowhere.
/// @param to layout.node_bytes() of them
void encode_node(const BvhNode& node, const path_tracer::NodeLayout& layout,
                 const std::vector<std::int32_t>& slot_of_node, std::uint8_t* to);

/// The box that the chip makes of an encoded child, and where it leads.
Box decode_box(const std::uint8_t* node, const path_tracer::NodeLayout& layout, int child);
path_tracer::ChildReference decode_reference(const std::uint8_t* node, const path_tracer::NodeLayout& layout,
                                             int child);

}  // namespace testbench
