#include "testbench/bvh/treelets.hpp"

#include <deque>
#include <queue>

#include "testbench/bvh/node_format.hpp"

namespace testbench {
namespace {

struct Candidate {
  double half_area;
  std::int32_t node;
  /// The largest comes first; among equals, the node that precedes the others in the tree.
  bool operator<(const Candidate& other) const {
    return half_area < other.half_area || (half_area == other.half_area && node > other.node);
  }
};

class Packer {
 public:
  Packer(const Bvh& bvh, const TreeletSizes& sizes) : bvh_(bvh) {
    packed_.sizes = sizes;
    packed_.slot_of_node.assign(bvh.nodes.size(), -1);
  }

  Treelets pack() {
    if (bvh_.nodes.empty()) return packed_;
    put(take_piece(0, packed_.sizes.resident), 0);
    while (!roots_.empty()) {
      const std::int32_t root = roots_.front();
      roots_.pop_front();
      place(take_piece(root, packed_.sizes.per_treelet));
    }
    return packed_;
  }

 private:
  /// The nodes of the piece that begins at `root`. Children that do not fit become roots of further pieces.
  std::vector<std::int32_t> take_piece(std::int32_t root, int most_nodes) {
    std::vector<std::int32_t> piece;
    std::priority_queue<Candidate> candidates;
    candidates.push({0.0, root});
    while (!candidates.empty() && piece.size() < std::size_t(most_nodes)) {
      const std::int32_t node = candidates.top().node;
      candidates.pop();
      piece.push_back(node);
      const BvhNode& children = bvh_.nodes[std::size_t(node)];
      for (int i = 0; i < children.child_count; ++i) {
        const BvhChild& child = children.child[std::size_t(i)];
        if (!child.is_leaf()) candidates.push({child.box.half_area(), child.node});
      }
    }
    for (; !candidates.empty(); candidates.pop()) roots_.push_back(candidates.top().node);
    return piece;
  }

  /// Puts a piece into the open treelet if it fits, else into a new treelet. The treelet with more room left
  /// stays open.
  void place(const std::vector<std::int32_t>& piece) {
    const int size = static_cast<int>(piece.size());
    const int most = packed_.sizes.per_treelet;
    std::int32_t slot = open_slot_;
    if (size > open_slots_) {
      slot = static_cast<std::int32_t>(packed_.slots());
      ++packed_.count;
      if (most - size >= open_slots_) {
        open_slot_ = slot + size;
        open_slots_ = most - size;
      }
    } else {
      open_slot_ += size;
      open_slots_ -= size;
    }
    put(piece, slot);
  }

  void put(const std::vector<std::int32_t>& piece, std::int32_t slot) {
    for (const std::int32_t node : piece) packed_.slot_of_node[std::size_t(node)] = slot++;
  }

  const Bvh& bvh_;
  Treelets packed_;
  std::deque<std::int32_t> roots_;
  std::int32_t open_slot_ = 0;
  int open_slots_ = 0;
};

}  // namespace

Treelets pack_treelets(const Bvh& bvh, const TreeletSizes& sizes) {
  return Packer(bvh, sizes).pack();
}

std::vector<std::uint8_t> encode_treelets(const Bvh& bvh, const Treelets& treelets,
                                          const path_tracer::NodeLayout& layout) {
  const auto node_bytes = std::size_t(layout.node_bytes());
  std::vector<std::uint8_t> bytes(std::size_t(treelets.slots()) * node_bytes);
  if (bvh.nodes.empty()) encode_node(BvhNode{}, layout, {}, bytes.data());
  for (std::size_t node = 0; node < bvh.nodes.size(); ++node)
    encode_node(bvh.nodes[node], layout, treelets.slot_of_node,
                bytes.data() + std::size_t(treelets.slot_of_node[node]) * node_bytes);
  return bytes;
}

}  // namespace testbench
