#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/node_layout.hpp"
#include "testbench/bvh/bvh.hpp"

namespace testbench {

/// How many nodes the resident piece and each treelet hold.
struct TreeletSizes {
  int resident = 1;     ///< nodes around the root, which every PE keeps
  int per_treelet = 1;  ///< nodes that a PE loads at a time
};

/// A tree cut into treelets, pieces that a PE loads as a whole. Node n lies in slot slot_of_node[n]. The
/// slots of one treelet are adjacent; the slots of the resident piece precede all others. The root has slot
/// 0.
struct Treelets {
  TreeletSizes sizes;
  std::int32_t count = 0;  ///< number of treelets, without the resident piece
  std::vector<std::int32_t> slot_of_node;

  std::int64_t slots() const { return sizes.resident + std::int64_t(count) * sizes.per_treelet; }
  /// The number of the treelet that holds the node; -1 for the resident piece.
  std::int32_t treelet_of_node(std::int32_t node) const {
    const std::int32_t slot = slot_of_node[std::size_t(node)];
    return slot < sizes.resident ? -1 : (slot - sizes.resident) / sizes.per_treelet;
  }
};

/// Fills each piece from its root downwards with the nodes of the largest surface area, which rays are most
/// likely to visit next (Aila, Karras, "Architecture Considerations for Tracing Incoherent Rays", HPG 2010).
/// Small remaining sub-trees at the bottom of the tree share treelets.
/// @param sizes at least 1 each
Treelets pack_treelets(const Bvh& bvh, const TreeletSizes& sizes);

/// The tree in mono memory: slots() nodes, with unused slots zero. A tree without nodes becomes one node
/// whose children lead nowhere.
std::vector<std::uint8_t> encode_treelets(const Bvh& bvh, const Treelets& treelets,
                                          const path_tracer::NodeLayout& layout);

}  // namespace testbench
