#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/node_layout.hpp"
#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// How many nodes go where.
struct TreeletSizes {
  int resident = 1;     ///< nodes around the root, which every PE keeps
  int per_treelet = 1;  ///< nodes that a PE loads at a time
};

/// A tree cut into pieces that a PE loads as a whole: node n lies in slot slot_of_node[n], slots of one
/// treelet side by side, those of the resident piece before all others. The root has slot 0.
struct Treelets {
  TreeletSizes sizes;
  std::int32_t count = 0;  ///< of treelets, without the resident piece
  std::vector<std::int32_t> slot_of_node;

  std::int64_t slots() const { return sizes.resident + std::int64_t(count) * sizes.per_treelet; }
  /// -1: the resident piece.
  std::int32_t treelet_of_node(std::int32_t node) const {
    const std::int32_t slot = slot_of_node[std::size_t(node)];
    return slot < sizes.resident ? -1 : (slot - sizes.resident) / sizes.per_treelet;
  }
};

/// Fills each piece from its root downwards with the nodes of the largest surface area, which rays most
/// likely ask for next (Aila, Karras, "Architecture Considerations for Tracing Incoherent Rays", HPG 2010).
/// What is left of sub-trees at the bottom of the tree shares treelets.
/// @param sizes at least 1 each
Treelets pack_treelets(const Bvh& bvh, const TreeletSizes& sizes);

/// The tree in mono memory: slots() nodes, unused slots zero. Of no nodes: one that leads nowhere.
std::vector<std::uint8_t> encode_treelets(const Bvh& bvh, const Treelets& treelets,
                                          const path_tracer::NodeLayout& layout);

}  // namespace testbench
