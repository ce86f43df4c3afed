#include "firmware/path_tracer/traversals/tree_search.hpp"

#include "firmware/path_tracer/traversals/large_packets.hpp"
#include "firmware/path_tracer/traversals/packet_stage.hpp"
#include "firmware/path_tracer/traversals/ray_streams.hpp"
#include "firmware/path_tracer/traversals/refill.hpp"
#include "firmware/path_tracer/traversals/shared_treelets.hpp"
#include "firmware/path_tracer/traversals/temporary_bin.hpp"

namespace path_tracer {
namespace {

std::unique_ptr<TreeTraversal> make_traversal(const StageContext& context, TreeContext& tree) {
  const Traversal traversal = context.config.traversal;
  if (traversal == Traversal::temporary_bin) return std::make_unique<TemporaryBinTraversal>(context, tree);
  if (traversal == Traversal::packets) return std::make_unique<PacketTraversal>(context, tree);
  if (traversal == Traversal::large_packets)
    return std::make_unique<PacketOfBlocksTraversal<LargePacketStage>>(context, tree);
  if (traversal == Traversal::ray_streams)
    return std::make_unique<PacketOfBlocksTraversal<RayStreamStage>>(context, tree);
  if (traversal == Traversal::shared_treelets) return std::make_unique<SharedTreeletTraversal>(context, tree);
  return std::make_unique<RefillTraversal>(context, tree);
}

}  // namespace

TreeSearch::TreeSearch(const StageContext& context)
    : queue_(context.machine, context.kernels, context.layout),
      tree_(context.machine, context.config, context.layout, queue_),
      traversal_(make_traversal(context, tree_)),
      recall_(context, [this](int /*block*/) { return tree_.last_hit_step; }) {}

TreeTraversal::Plan TreeSearch::plan_in(StepPipeline& steps) {
  return [&](Stage& stage, int block) {
    steps.plan(stage, block);
    ++steps_left_;
  };
}

bool TreeSearch::begin_pass(StepPipeline& steps, const std::vector<int>& blocks) {
  if (blocks.empty()) return true;
  tree_.finished = 0;
  traversal_->plan_first(plan_in(steps));
  return false;
}

bool TreeSearch::after_step(StepPipeline& steps, const Step& step, const std::vector<int>& blocks) {
  traversal_->after_step(*step.stage, step.block, plan_in(steps));
  if (--steps_left_ > 0) return false;
  queue_.clear();
  for (const int block : blocks) steps.plan(recall_, block);
  return true;
}

}  // namespace path_tracer
