#include "firmware/path_tracer/traversals/shared_treelets.hpp"

namespace path_tracer {
namespace {

// Instructions of the control unit (assumed). To append rays, it looks up the treelet's block in a table of
// mono memory that is seldom in the data cache, and changes two entries. To take a block, it looks for the
// fullest in lists by number of rays.
constexpr std::uint64_t kAppendInstructions = 60;
constexpr std::uint64_t kTakeInstructions = 60;

}  // namespace

SharedTreeletContext::SharedTreeletContext(cn::Machine& machine, const ProgramConfig& config,
                                           const Layout& layout)
    : records(machine, config),
      queues(layout, config, machine.num_pes()),
      number{machine.poly_memory().allocate("numbers of rays that go on", sizeof(std::int32_t)).offset_bytes},
      slot_bits(bits_of(layout.tree_slots)) {}

void SharedTreeletStage::put_back(std::uint64_t step, const LaneMask& rays, const LaneMask& alive,
                                  std::size_t /*pass*/) {
  const int going_on = context_.machine.count(alive);
  if (going_on > 0) sort(step, alive, going_on);
  rays_.queues.forget(rays.count() - going_on);
}

/// Appends treelet by treelet; rays without room there go into the mixed queue at the end.
void SharedTreeletStage::sort(std::uint64_t step, const LaneMask& alive, int rays) {
  Needs needs;
  locate(step, records_.record(step), alive, needs);
  LaneMask left = needs.treelet;
  LaneMask mixed = alive.without(left);
  int unsorted = context_.machine.count(left);
  int in_mixed = rays - unsorted;
  while (unsorted > 0) {
    const std::int32_t treelet = least_treelet(step, left);
    const LaneMask lanes = rays_of_treelet(step, treelet, left);
    const int count = context_.machine.count(lanes);
    if (rays_.queues.has_room(treelet, count)) {
      append(step, treelet, lanes, count);
    } else {
      mixed = mixed.with(lanes);
      in_mixed += count;
    }
    left = left.without(lanes);
    unsorted -= count;
  }
  if (in_mixed > 0) append(step, TreeletQueues::kMixed, mixed, in_mixed);
}

std::int32_t SharedTreeletStage::least_treelet(std::uint64_t step, const LaneMask& rays) {
  std::int32_t least = context_.layout.tree_slots;
  context_.machine.run(kernels_.least, LeastArguments{loads(step).treelet, rays_.slot_bits, &least}, rays);
  return least;
}

LaneMask SharedTreeletStage::rays_of_treelet(std::uint64_t step, std::int32_t treelet, const LaneMask& rays) {
  LaneMask equal;
  context_.machine.run(kernels_.equal, EqualArguments{loads(step).treelet, treelet, &equal}, rays);
  return equal;
}

/// Appends rays to the queue of a treelet. A single ray needs no number.
void SharedTreeletStage::append(std::uint64_t step, std::int32_t treelet, const LaneMask& lanes, int rays) {
  if (rays > 1) context_.machine.number_ascending(lanes, rays_.number);
  context_.machine.issue_mono(kAppendInstructions);
  const TreeletQueues::Room where = rays_.queues.append(treelet, rays, step);
  AppendToBlocksArguments arguments;
  arguments.number = rays_.number;
  arguments.rays = rays;
  arguments.room = where.room;
  arguments.address = where.address;
  arguments.next_address = where.next_address;
  arguments.record_bytes = records_.record_bytes();
  arguments.place = records_.record_to(step);
  context_.machine.run(kernels_.append_to_blocks, arguments, lanes);
}

GroupStage::GroupStage(const StageContext& context, TreeContext& tree, SharedTreeletContext& rays)
    : SharedTreeletStage(context, tree, rays), states_(std::size_t(RecordRing::buffers(context.config))) {}

void GroupStage::load(std::uint64_t step, int block) {
  const TreeletQueues::Block& group = rays_.queues.block(block);
  state(step).rays = LaneMask::first(group.rays);
  state(step).treelet = group.treelet;
  records_.load(step, rays_.queues.address_of(block), group.last_writer, state(step).rays);
}

void GroupStage::prepare(std::uint64_t step, int block) {
  records_.wait(step);
  rays_.queues.release(block);
  State& prepared = state(step);
  locate(step, records_.record(step), prepared.rays, prepared.needs);
  load_leaves(step, prepared.needs);
  if (prepared.treelet == TreeletQueues::kMixed) load_treelets(step, prepared.needs);
}

void GroupStage::process(std::uint64_t step, int /*block*/) {
  const State& prepared = state(step);
  if (prepared.treelet != TreeletQueues::kMixed) broadcast(step, prepared);
  traverse_and_put_back(step, prepared.rays, prepared.needs, 1);
}

void GroupStage::broadcast(std::uint64_t step, const State& state) {
  const auto node_words = std::uint64_t(tree_.tree.shape.layout.node_bytes()) / sizeof(std::uint64_t);
  const cn::MonoPointer<std::uint64_t> treelet =
      context_.layout.nodes + std::uint64_t(state.treelet) * node_words;
  BroadcastArguments arguments;
  arguments.words = tree_.tree.shape.treelet_nodes * static_cast<int>(node_words);
  arguments.word = context_.machine.read_mono(treelet, std::size_t(arguments.words));
  arguments.to_offset = loads(step).treelet_offset;
  context_.machine.run(kernels_.broadcast, arguments, state.rays);
}

SharedTreeletTraversal::SharedTreeletTraversal(const StageContext& context, TreeContext& tree)
    : machine_(context.machine),
      queue_(tree.queue),
      most_planned_(record_steps(context.config)),
      rays_(context.machine, context.config, context.layout),
      begin_(context, tree, rays_),
      group_(context, tree, rays_) {}

void SharedTreeletTraversal::plan_first(const Plan& plan) {
  rays_.queues.expect(queue_.rays());
  steps_left_ = (queue_.rays() + machine_.num_pes() - 1) / machine_.num_pes();
  for (int block = 0; block < steps_left_; ++block) plan(begin_, block);
}

/// Plans as many steps as may be loaded at a time. If it waited longer for blocks to become full, the
/// pipeline would run dry.
void SharedTreeletTraversal::after_step(const Stage& /*stage*/, int /*block*/, const Plan& plan) {
  --steps_left_;
  while (steps_left_ < most_planned_) {
    const std::optional<int> block = take_block();
    if (!block) return;
    machine_.issue_mono(kTakeInstructions);
    plan(group_, *block);
    ++steps_left_;
  }
}

std::optional<int> SharedTreeletTraversal::take_block() {
  const std::optional<int> full = rays_.queues.take_full();
  return full ? full : rays_.queues.take_fullest();
}

}  // namespace path_tracer
