#include "firmware/path_tracer/temporary_bin.hpp"

namespace path_tracer {

/// From the load, which is begun two steps of n ahead since a ray's leaf is known only when the ray is there, to
/// the end of the save.
int TemporaryBinContext::record_buffers(const ProgramConfig& config) {
  return 2 * config.load_buffers() - 1 + config.save_buffers() - 1;
}

TemporaryBinContext::TemporaryBinContext(cn::Machine& machine, const ProgramConfig& config,
                                         const Layout& layout)
    : records(machine, "traversal record",
              {record_buffers(config), config.tree.record_bytes() + int{sizeof(MonoAddress)}, false}),
      bin(layout, config, machine.num_pes()),
      number{machine.poly_memory().allocate("numbers of rays that go on", sizeof(std::int32_t)).offset_bytes} {}

PolyField<MonoAddress> TemporaryBinStage::record_to(std::uint64_t step) const {
  return {rays_.records.buffer(step).offset_bytes + rays_.bin.record_bytes()};
}

void TemporaryBinStage::traverse_and_sort(std::uint64_t step, const LaneMask& rays, const Needs& needs,
                                          std::size_t pass) {
  count_pass(pass, rays);
  alive_ = traverse(step, record(step), rays, needs);
  const int going_on = context_.machine.number_ascending(alive_, rays_.number);
  if (going_on > 0) {
    AppendRaysArguments arguments;
    arguments.number = rays_.number;
    arguments.bin = rays_.bin.address();
    arguments.record_bytes = rays_.bin.record_bytes();
    arguments.tail = rays_.bin.tail();
    arguments.capacity = rays_.bin.capacity();
    arguments.place = record_to(step);
    context_.machine.run(kernels_.append_rays, arguments, alive_);
  }
  rays_.bin.append(going_on, step, pass);
  finish(step, record(step), rays.without(alive_));
}

void TemporaryBinStage::save(std::uint64_t step, int /*block*/) {
  rays_.records.copy_p2m(step, kNoBlock, context_.machine.places_in(record_to(step)),
                         {rays_.records.buffer(step).offset_bytes, rays_.bin.record_bytes()}, alive_);
  if (!context_.config.buffers_saves()) rays_.records.wait(step);
  save_hits(step);
}

void BeginStage::load(std::uint64_t step, int block) {
  load_packed_rays(step, block);
}

void BeginStage::process(std::uint64_t step, int block) {
  const LaneMask rays = packed_rays(block);
  rays_.records.wait(step);
  enter(step, record(step), rays);
  traverse_and_sort(step, rays, Needs{}, 0);
}

TraverseStage::TraverseStage(const StageContext& context, TreeContext& tree, TemporaryBinContext& rays)
    : TemporaryBinStage(context, tree, rays),
      states_(std::size_t(TemporaryBinContext::record_buffers(context.config))) {}

void TraverseStage::load(std::uint64_t step, int block) {
  state(step).rays = LaneMask::first(rays_.bin.rays(block));
  TransferRing& records = rays_.records;
  records.wait(step);
  records.wait_until(rays_.bin.last_writer(block));
  const int bytes = rays_.bin.record_bytes();
  records.copy_m2p(step, kNoBlock, {records.buffer(step).offset_bytes, bytes},
                   cn::MonoPlaces::array(rays_.bin.address_of(block), std::uint64_t(bytes)), state(step).rays);
  if (!context_.config.buffers_loads()) records.wait(step);
}

void TraverseStage::prepare(std::uint64_t step, int /*block*/) {
  rays_.records.wait(step);
  load_tree(step, record(step), state(step).rays, state(step).needs);
}

void TraverseStage::process(std::uint64_t step, int block) {
  traverse_and_sort(step, state(step).rays, state(step).needs, rays_.bin.pass(block));
}

TemporaryBinTraversal::TemporaryBinTraversal(const StageContext& context, TreeContext& tree)
    : TreeTraversal(context, tree),
      queue_(*context.queue),
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

/// A block that is partly full is processed only when nothing is left that might fill it.
void TemporaryBinTraversal::after_step(const Stage& /*stage*/, int /*block*/, const Plan& plan) {
  --steps_left_;
  while (const std::optional<int> block = rays_.bin.take_full()) plan_block(plan, *block);
  if (steps_left_ > 0) return;
  if (const std::optional<int> rest = rays_.bin.take_rest()) plan_block(plan, *rest);
}

}  // namespace path_tracer
