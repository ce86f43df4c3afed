#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/node_layout.hpp"
#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// A tree cut into pieces that a PE loads as a whole: node n lies in slot slot_of_node[n], slots of one
/// treelet side by side. The root has slot 0.
struct Treelets {
  int nodes_per_treelet = 1;
  std::int32_t count = 0;
  std::vector<std::int32_t> slot_of_node;

  std::int32_t treelet_of_node(std::int32_t node) const {
    return slot_of_node[std::size_t(node)] / nodes_per_treelet;
  }
};

/// Fills each treelet from its root downwards with the nodes of the largest surface area, which rays most
/// likely ask for next (Aila, Karras, "Architecture Considerations for Tracing Incoherent Rays", HPG 2010).
/// What is left of sub-trees at the bottom of the tree shares treelets.
/// @param nodes_per_treelet at least 1
Treelets pack_treelets(const Bvh& bvh, int nodes_per_treelet);

/// The tree in mono memory: count * nodes_per_treelet nodes, unused slots zero.
std::vector<std::uint8_t> encode_treelets(const Bvh& bvh, const Treelets& treelets,
                                          const path_tracer::NodeLayout& layout);

}  // namespace testbench
