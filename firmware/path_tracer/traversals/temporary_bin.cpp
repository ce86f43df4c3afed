#include "firmware/path_tracer/traversals/temporary_bin.hpp"

namespace path_tracer {

TemporaryBinContext::TemporaryBinContext(cn::Machine& machine, const ProgramConfig& config,
                                         const Layout& layout)
    : records(machine, config),
      bin(layout, config, machine.num_pes()),
      number{
          machine.poly_memory().allocate("numbers of rays that go on", sizeof(std::int32_t)).offset_bytes} {}

void TemporaryBinStage::put_back(std::uint64_t step, const LaneMask& /*rays*/, const LaneMask& alive,
                                 std::size_t pass) {
  const int going_on = context_.machine.number_ascending(alive, rays_.number);
  if (going_on > 0) {
    AppendRaysArguments arguments;
    arguments.number = rays_.number;
    arguments.bin = rays_.bin.address();
    arguments.record_bytes = records_.record_bytes();
    arguments.tail = rays_.bin.tail();
    arguments.capacity = rays_.bin.capacity();
    arguments.place = records_.record_to(step);
    context_.machine.run(kernels_.append_rays, arguments, alive);
  }
  rays_.bin.append(going_on, step, pass);
}

TraverseStage::TraverseStage(const StageContext& context, TreeContext& tree, TemporaryBinContext& rays)
    : TemporaryBinStage(context, tree, rays), states_(std::size_t(RecordRing::buffers(context.config))) {}

void TraverseStage::load(std::uint64_t step, int block) {
  state(step).rays = LaneMask::first(rays_.bin.rays(block));
  records_.load(step, rays_.bin.address_of(block), rays_.bin.last_writer(block), state(step).rays);
}

void TraverseStage::prepare(std::uint64_t step, int /*block*/) {
  records_.wait(step);
  load_tree(step, records_.record(step), state(step).rays, state(step).needs);
}

void TraverseStage::process(std::uint64_t step, int block) {
  traverse_and_put_back(step, state(step).rays, state(step).needs, rays_.bin.pass(block));
}

TemporaryBinTraversal::TemporaryBinTraversal(const StageContext& context, TreeContext& tree)
    : queue_(tree.queue),
      num_pes_(context.machine.num_pes()),
      rays_(context.machine, context.config, context.layout),
      begin_(context, tree, rays_),
      traverse_(context, tree, rays_) {}

void TemporaryBinTraversal::plan_first(const Plan& plan) {
  steps_left_ = (queue_.rays() + num_pes_ - 1) / num_pes_;
  for (int block = 0; block < steps_left_; ++block) plan(begin_, block);
}

void TemporaryBinTraversal::plan_block(const Plan& plan, int block) {
  plan(traverse_, block);
  ++steps_left_;
}

/// A partly full block is processed only when no other step can fill it.
void TemporaryBinTraversal::after_step(const Stage& /*stage*/, int /*block*/, const Plan& plan) {
  --steps_left_;
  while (const std::optional<int> block = rays_.bin.take_full()) plan_block(plan, *block);
  if (steps_left_ > 0) return;
  if (const std::optional<int> rest = rays_.bin.take_rest()) plan_block(plan, *rest);
}

}  // namespace path_tracer
