#include "firmware/path_tracer/traversals/large_packets.hpp"

#include <algorithm>
#include <limits>

namespace path_tracer {

LargePacketStage::LargePacketStage(const StageContext& context, TreeContext& tree, PacketOfBlocks& rays)
    : PacketWalkStage(context, tree, rays),
      large_packet_kernels_(context.kernels.large_packet()),
      bounds_at_{context.machine.poly_memory()
                     .allocate("packet's bounds", kPacketBounds * int{sizeof(std::int32_t)})
                     .offset_bytes} {}

void LargePacketStage::add_block(int number) {
  BoundArguments arguments;
  arguments.record = rays_[number].record;
  arguments.packet = rays_[number].packet;
  arguments.bounds = bounds_at_;
  arguments.is_first = number == 0;
  context_.machine.run(large_packet_kernels_.bound, arguments, rays_[number].rays);
}

/// The first block has a ray wherever another has one.
void LargePacketStage::take_bounds() {
  std::array<std::int32_t, kPacketBounds> least;
  least.fill(std::numeric_limits<std::int32_t>::max());
  context_.machine.run(large_packet_kernels_.keep_bounds, KeepBoundsArguments{bounds_at_, least.data()},
                       rays_[0].rays);
  bounds_ = PacketBounds(least);
}

void LargePacketStage::walk(int blocks) {
  take_bounds();
  stack_.assign(1, Entry{});
  stack_.back().reference = {0, 0};
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    charge_pop();
    if (entry.reference.count > 0) {
      test_leaf_from_first(entry, blocks);
    } else {
      visit(entry, blocks);
    }
  }
}

void LargePacketStage::find_first_blocks(const MonoNode& node, int from_block, int blocks, int* first_block,
                                         int* votes) {
  std::vector<int> undecided;
  for (int child = 0; child < node.children; ++child) {
    first_block[child] = -1;
    if (node.reference[child] == PackedReference::kNowhere) continue;
    if (bounds_.culls()) context_.machine.issue_mono(bounds_.instructions());
    if (!bounds_.culls() || !bounds_.misses(node, child)) undecided.push_back(child);
  }
  for (int block = from_block; block < blocks && !undecided.empty(); ++block) {
    LaneMask meets[kMaxNodeWidth];
    LaneMask enters_first[kMaxNodeWidth];
    const MeetArguments arguments{rays_[block].record, rays_[block].packet, &node, meets, enters_first};
    context_.machine.run(large_packet_kernels_.meet, arguments, rays_[block].rays);
    const auto is_met = [&](int child) {
      if (context_.machine.count(meets[child]) == 0) return false;
      first_block[child] = block;
      votes[child] = context_.machine.count(enters_first[child]);
      return true;
    };
    undecided.erase(std::remove_if(undecided.begin(), undecided.end(), is_met), undecided.end());
  }
}

void LargePacketStage::visit(const Entry& entry, int blocks) {
  const MonoNode node = read(entry.reference.first);
  int first_block[kMaxNodeWidth];
  int votes[kMaxNodeWidth];
  find_first_blocks(node, entry.first_block, blocks, first_block, votes);
  std::vector<VotedChild> children;
  for (int child = 0; child < node.children; ++child)
    if (first_block[child] >= 0) children.push_back({child, votes[child]});
  if (children.empty()) return;
  sort_children(children);
  charge_push(static_cast<int>(children.size()));
  for (const VotedChild& next : children) {
    const MonoNode::Four& four = node.four[next.child / 4];
    const auto i = static_cast<std::size_t>(next.child % 4);
    stack_.push_back({PackedReference::unpack(node.reference[next.child]),
                      first_block[next.child],
                      {four.lower[0][i], four.lower[1][i], four.lower[2][i], four.lower[2][i]},
                      {four.upper[0][i], four.upper[1][i], four.upper[2][i], four.upper[2][i]}});
  }
}

void LargePacketStage::test_leaf_from_first(const Entry& entry, int blocks) {
  for (int block = entry.first_block; block < blocks; ++block) {
    LaneMask meets;
    const MeetChildArguments arguments{rays_[block].record, rays_[block].packet, entry.lower, entry.upper,
                                       &meets};
    context_.machine.run(large_packet_kernels_.meet_child, arguments, rays_[block].rays);
    if (context_.machine.count(meets) == 0) continue;
    test_leaf(entry.reference.first, entry.reference.count, rays_[block], meets);
  }
}

}  // namespace path_tracer
