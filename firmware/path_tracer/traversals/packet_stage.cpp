#include "firmware/path_tracer/traversals/packet_stage.hpp"

namespace path_tracer {

PacketStage::PacketStage(const StageContext& context, TreeContext& tree) : PacketBase(context, tree) {
  cn::PolyMemory& memory = context.machine.poly_memory();
  BufferCutter cutter(memory.allocate("packet", int{sizeof(TraversalRecord)} + int{sizeof(PacketRecord)}));
  block_.record = cutter.take<TraversalRecord>();
  block_.packet = cutter.take<PacketRecord>();
  keys_ = PacketKeys(memory.allocate("packet's keys", PacketKeys::bytes(width())), width());
}

void PacketStage::load(std::uint64_t step, int block) {
  load_packed_rays(step, block);
}

void PacketStage::process(std::uint64_t step, int block) {
  block_.rays = packed_rays(block);
  enter(step, block_.record, block_.rays);
  count_pass(0, block_.rays);
  begin(step, block_, &keys_);
  walk();
  finish(step, block_.record, block_.rays);
}

void PacketStage::walk() {
  stack_.assign(1, {{0, 0}, 0, PacketKeys::kRoot});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    charge_pop();
    const LaneMask rays = rays_that_want(entry);
    if (context_.machine.count(rays) == 0) continue;
    if (entry.reference.count > 0) {
      test_leaf(entry.reference.first, entry.reference.count, block_, rays);
    } else {
      visit(entry, rays);
    }
  }
}

/// Asks the rays again, because a ray's limit may have decreased since its key was made.
LaneMask PacketStage::rays_that_want(const Entry& entry) {
  LaneMask wanting;
  WantArguments arguments;
  arguments.packet = block_.packet;
  arguments.keys = keys_;
  arguments.place = entry.place;
  arguments.is_node = entry.reference.count == 0;
  arguments.level = entry.level;
  arguments.wanting = &wanting;
  context_.machine.run(packet_kernels_.want, arguments, block_.rays);
  return wanting;
}

void PacketStage::visit(const Entry& entry, const LaneMask& rays) {
  const MonoNode node = read(entry.reference.first);
  LaneMask enters_first[kMaxNodeWidth];
  VisitArguments arguments;
  arguments.record = block_.record;
  arguments.packet = block_.packet;
  arguments.node = &node;
  arguments.keys = keys_;
  arguments.level = entry.level;
  arguments.enters_first = enters_first;
  context_.machine.run(packet_kernels_.visit, arguments, rays);
  push_children(node, entry.level, enters_first);
}

/// Pushes children in the order in which most rays need them: the child that most rays enter first comes
/// first. An order by the signs of most directions needs no votes, but visits so many more nodes that it is
/// no faster. Without a vote, no ray meets any child.
void PacketStage::push_children(const MonoNode& node, int level, const LaneMask* enters_first) {
  std::vector<VotedChild> children;
  int all_votes = 0;
  for (int i = 0; i < node.children; ++i) {
    children.push_back({i, context_.machine.count(enters_first[i])});
    all_votes += children.back().votes;
  }
  if (all_votes == 0) return;
  sort_children(children);
  charge_push(node.children);
  for (const VotedChild& next : children)
    stack_.push_back(
        {PackedReference::unpack(node.reference[next.child]), level + 1, keys_.place(level, next.child)});
}

void PacketTraversal::plan_first(const Plan& plan) {
  for (int block = 0; block * num_pes_ < queue_.rays(); ++block) plan(stage_, block);
}

}  // namespace path_tracer
