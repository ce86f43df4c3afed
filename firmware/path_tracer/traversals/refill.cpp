#include "firmware/path_tracer/traversals/refill.hpp"

#include <algorithm>

namespace path_tracer {

RefillStage::RefillStage(const StageContext& context, TreeContext& tree)
    : TreeStage(context, tree),
      groups_(std::size_t(context.config.load_buffers())),
      number_{
          context.machine.poly_memory().allocate("numbers of idle PEs", sizeof(std::int32_t)).offset_bytes},
      least_idle_(context.config.traversal == Traversal::lock_step ? num_pes() : 1) {
  const int bytes = tree.tree.shape.record_bytes();
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const cn::PolySpan rays = context.machine.poly_memory().allocate("rays " + std::to_string(i), bytes);
    groups_[i].record = PolyPointer<TraversalRecord>(rays);
    groups_[i].passes.resize(std::size_t(num_pes()));
  }
}

void RefillStage::load(std::uint64_t step, int index) {
  Group& group = groups_[std::size_t(index)];
  group.needs = Needs{};
  if (group.going_on > 0) load_tree(step, group.record, group.alive, group.needs);
  load_rays(step, group);
}

void RefillStage::load_rays(std::uint64_t step, Group& group) {
  RayQueue& queue = tree_.queue;
  group.fresh = LaneMask{};
  const int idle = num_pes() - group.going_on;
  const int count = std::min(idle, queue.left());
  if (count == 0 || idle < least_idle_) return;
  context_.saves.wait_until(queue.last_writer());
  const Loads to = loads(step);
  const LaneMask idle_pes = LaneMask::first(num_pes()).without(group.alive);
  context_.machine.number_ascending(idle_pes, number_);
  TakeRaysArguments arguments;
  arguments.number = number_;
  arguments.rays = count;
  arguments.first_place = queue.next_place();
  arguments.place = to.ray_place;
  arguments.takes = &group.fresh;
  context_.machine.run(kernels_.take_rays, arguments, idle_pes);
  context_.loads.copy_m2p(step, TransferRing::kNoBlock, to.ray.span(),
                          context_.machine.places_in(to.ray_place), group.fresh);
  queue.take(count);
}

void RefillStage::process(std::uint64_t step, int index) {
  Group& group = groups_[std::size_t(index)];
  if (group.fresh.any()) enter(step, group.record, group.fresh);
  const LaneMask rays = group.alive.with(group.fresh);
  count_turns(group, rays);
  group.alive = traverse(step, group.record, rays, group.needs);
  group.going_on = context_.machine.count(group.alive);
  finish(step, group.record, rays.without(group.alive));
}

/// Statistics of the simulator; the chip does not count, so this is free.
void RefillStage::count_turns(Group& group, const LaneMask& rays) {
  count_rays(0, std::uint64_t(group.fresh.count()));
  count_lanes(0, rays);  // all PEs
  for (int pe = 0; pe < num_pes(); ++pe) {
    std::size_t& pass = group.passes[std::size_t(pe)];
    if (group.fresh[pe]) {
      pass = 0;
    } else if (rays[pe]) {
      count_rays(++pass, 1);
    }
  }
}

void RefillTraversal::plan_first(const Plan& plan) {
  for (int group = 0; group < stage_.groups(); ++group) plan(stage_, group);
}

void RefillTraversal::after_step(const Stage& /*stage*/, int group, const Plan& plan) {
  if (stage_.has_rays(group) || queue_.left() > 0) plan(stage_, group);
}

}  // namespace path_tracer
