#include "firmware/path_tracer/traversals/ray_streams.hpp"

namespace path_tracer {

RayStreamStage::RayStreamStage(const StageContext& context, TreeContext& tree, PacketOfBlocks& rays)
    : PacketWalkStage(context, tree, rays), ray_stream_kernels_(context.kernels.ray_stream()) {
  const cn::PolySpan sets =
      context.machine.poly_memory().allocate("sets of active rays", PacketKeys::bytes(width()));
  stream_ = {rays.offset_bytes(), PacketKeys(sets, width())};
}

void RayStreamStage::add_block(int number) {
  context_.machine.run(ray_stream_kernels_.fill_set, FillSetArguments{stream_, number, number == 0},
                       rays_[number].rays);
}

/// The first block has a ray wherever another has one.
void RayStreamStage::walk(int /*blocks*/) {
  stack_.assign(1, {{0, 0}, 0, PacketKeys::kRoot});
  while (!stack_.empty()) {
    const Entry entry = stack_.back();
    stack_.pop_back();
    charge_pop();
    if (entry.reference.count > 0) {
      test_leaf_set(entry);
    } else {
      visit(entry);
    }
  }
}

void RayStreamStage::visit(const Entry& entry) {
  const MonoNode node = read(entry.reference.first);
  LaneMask active[kMaxNodeWidth];
  LaneMask enters_first[kMaxNodeWidth];
  FilterArguments arguments;
  arguments.rays = stream_;
  arguments.node = &node;
  arguments.place = entry.place;
  arguments.level = entry.level;
  arguments.active = active;
  arguments.enters_first = enters_first;
  context_.machine.run(ray_stream_kernels_.filter, arguments, rays_[0].rays);
  std::vector<VotedChild> children;
  for (int child = 0; child < node.children; ++child) {
    if (node.reference[child] == PackedReference::kNowhere) continue;
    if (context_.machine.count(active[child]) == 0) continue;
    children.push_back({child, context_.machine.count(enters_first[child])});
  }
  if (children.empty()) return;
  sort_children(children);
  charge_push(static_cast<int>(children.size()));
  for (const VotedChild& next : children)
    stack_.push_back({PackedReference::unpack(node.reference[next.child]), entry.level + 1,
                      stream_.sets.place(entry.level, next.child)});
}

void RayStreamStage::test_leaf_set(const Entry& entry) {
  TestSetArguments arguments;
  arguments.rays = stream_;
  arguments.place = entry.place;
  arguments.triangles = triangles(entry.reference.first, entry.reference.count);
  arguments.count = entry.reference.count;
  arguments.reach = tree_.reach;
  arguments.layers = context_.layout.layers;
  context_.machine.run(ray_stream_kernels_.test_set, arguments, rays_[0].rays);
}

}  // namespace path_tracer
