#include "firmware/path_tracer/traversal_stages.hpp"

namespace path_tracer {

TraversalBin::TraversalBin(const Layout& layout, const ProgramConfig& config, int num_pes)
    : first_(layout.traversal_bin.address),
      record_bytes_(config.tree.record_bytes()),
      num_pes_(num_pes),
      blocks_(traversal_bin_blocks(config)),
      block_(std::size_t(blocks_)) {}

int TraversalBin::take(int rays) {
  while (passes_.size() > 1 && passes_[1].ray <= head_) passes_.pop_front();
  const auto index = static_cast<int>(head_ / std::uint64_t(num_pes_) % std::uint64_t(blocks_));
  block_[std::size_t(index)].rays = rays;
  block_[std::size_t(index)].pass = passes_.front().pass;
  head_ += std::uint64_t(num_pes_);
  return index;
}

std::optional<int> TraversalBin::take_full() {
  if (tail_ < head_ + std::uint64_t(num_pes_)) return {};
  return take(num_pes_);
}

std::optional<int> TraversalBin::take_rest() {
  if (tail_ == head_) return {};
  const int block = take(static_cast<int>(tail_ - head_));
  tail_ = head_;
  return block;
}

void TraversalBin::append(int rays, std::uint64_t step, std::size_t pass) {
  if (tail_ == head_) passes_.clear();
  if (passes_.empty() || passes_.back().pass != pass + 1) passes_.push_back({tail_, pass + 1});
  const auto pes = std::uint64_t(num_pes_);
  for (std::uint64_t block = tail_ / pes; block * pes < tail_ + std::uint64_t(rays); ++block)
    block_[std::size_t(block % std::uint64_t(blocks_))].last_writer = step;
  tail_ += std::uint64_t(rays);
}

/// From the load, which is begun two steps of n ahead since a ray's leaf is known only when the ray is there, to
/// the end of the save.
int TraversalContext::record_buffers(const ProgramConfig& config) {
  return 2 * config.load_buffers() - 1 + config.save_buffers() - 1;
}

TraversalContext::TraversalContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout)
    : records(machine, "traversal record",
              {record_buffers(config), config.tree.record_bytes() + int{sizeof(MonoAddress)}, false}),
      bin(layout, config, machine.num_pes()),
      tree{config.tree, 0, 0},
      reach(layout.reach),
      machine_(machine),
      layout_(layout) {
  tree.resident_offset =
      machine.poly_memory().allocate("resident nodes", tree.shape.resident_bytes()).offset_bytes;
}

void TraversalContext::load_resident_nodes() {
  records.copy_m2p(0, -1, {tree.resident_offset, tree.shape.resident_bytes()},
                   cn::MonoPlaces::array(layout_.nodes.address, 0), LaneMask::first(machine_.num_pes()));
  records.wait(0);
}

TraversalStage::TraversalStage(const StageContext& context, TraversalContext& traversal)
    : Stage(context),
      traversal_(traversal),
      kernels_(context.kernels.traversal()),
      number_{context.machine.poly_memory()
                  .allocate("ascending numbers of rays", sizeof(std::int32_t))
                  .offset_bytes} {}

TraversalStage::Hits TraversalStage::hits(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  return {cutter.take<HitRecord>(), cutter.take_place(), cutter.take_place(), cutter.take_place()};
}

PolyField<MonoAddress> TraversalStage::record_to(std::uint64_t step) const {
  return {traversal_.records.buffer(step).offset_bytes + traversal_.tree.shape.record_bytes()};
}

void TraversalStage::sort_out(std::uint64_t step, const LaneMask& rays, std::size_t pass) {
  count(pass, rays.count());
  finished_ = rays.without(alive_);
  const int going_on = context_.machine.number_ascending(alive_, number_);
  if (going_on > 0) {
    AppendRaysArguments arguments;
    arguments.number = number_;
    arguments.bin = traversal_.bin.address();
    arguments.record_bytes = traversal_.bin.record_bytes();
    arguments.tail = traversal_.bin.tail();
    arguments.capacity = traversal_.bin.capacity();
    arguments.place = record_to(step);
    context_.machine.run(kernels_.append_rays, arguments, alive_);
  }
  traversal_.bin.append(going_on, step, pass);
  const int finished = rays.count() - going_on;
  traversal_.finished += std::uint64_t(finished);
  if (finished == 0) return;
  const Hits to = hits(step);
  FinishArguments arguments;
  arguments.record = record(step);
  arguments.surfaces = context_.layout.surfaces.address;
  arguments.hits = context_.layout.intersection_bin.address;
  arguments.surface_places = context_.layout.surface_place_bin.address;
  arguments.hit = to.hit;
  arguments.surface_place = to.surface_place;
  arguments.hit_to = to.hit_to;
  arguments.surface_place_to = to.surface_place_to;
  context_.machine.run(kernels_.finish, arguments, finished_);
}

void TraversalStage::save(std::uint64_t step, int /*block*/) {
  constexpr int kNoBlock = -1;  // of the slots
  const cn::PolySpan buffer{traversal_.records.buffer(step).offset_bytes, traversal_.bin.record_bytes()};
  traversal_.records.copy_p2m(step, kNoBlock, context_.machine.places_in(record_to(step)), buffer, alive_);
  if (!context_.config.buffers_saves()) traversal_.records.wait(step);
  const Hits from = hits(step);
  context_.saves.copy_p2m(step, kNoBlock, context_.machine.places_in(from.hit_to), from.hit.span(), finished_);
  context_.saves.copy_p2m(step, kNoBlock, context_.machine.places_in(from.surface_place_to),
                          {from.surface_place.offset_bytes, sizeof(MonoAddress)}, finished_);
  traversal_.last_step = step;
}

/// Beside what the chip does, so it costs nothing.
void TraversalStage::count(std::size_t pass, int rays) {
  TraversalCounts& counts = context_.counts.traversal;
  if (counts.rays.size() <= pass) {
    counts.rays.resize(pass + 1);
    counts.lanes.resize(pass + 1);
  }
  const auto lanes = std::uint64_t(num_pes());
  counts.rays[pass] += std::uint64_t(rays);
  counts.lanes[pass] += lanes;
  if (pass == 0 || 20 * traversal_.finished >= 19 * traversal_.begun) return;
  counts.rays_before_tail += std::uint64_t(rays);
  counts.lanes_before_tail += lanes;
}

void BeginStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const PolyPointer<RayRecord> ray(context_.loads.buffer(step));
  load_block(step, block, ray, context_.layout.ray_bin, bin_block(block).live);
}

void BeginStage::process(std::uint64_t step, int block) {
  const Bins::Block& bin = bin_block(block);
  traversal_.records.wait(step);
  alive_ = LaneMask{};
  BeginArguments arguments;
  arguments.ray = PolyPointer<RayRecord>(context_.loads.buffer(step));
  arguments.light_place = bin.light_place;
  arguments.lights = context_.layout.lights.address;
  arguments.first_light_run = context_.layout.triangle_count;
  arguments.first_slot = static_cast<int>(first_slot(block));
  arguments.tree = traversal_.tree;
  arguments.record = record(step);
  arguments.alive = &alive_;
  context_.machine.run(kernels().begin[format()], arguments, bin.live);
  context_.counts.segments += std::uint64_t(bin.segments().count());
  context_.counts.shadow_rays += std::uint64_t(bin.shadow.count());
  traversal_.begun += std::uint64_t(bin.live.count());
  sort_out(step, bin.live, 0);
}

TraverseStage::TraverseStage(const StageContext& context, TraversalContext& traversal)
    : TraversalStage(context, traversal),
      states_(std::size_t(TraversalContext::record_buffers(context.config))) {}

int TraverseStage::load_bytes(const TreeShape& shape) {
  return 3 * int{sizeof(MonoAddress)} + shape.leaf_records() * int{sizeof(TriangleRecord)} +
         shape.treelet_bytes();
}

TraverseStage::Loads TraverseStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  Loads loads;
  loads.leaf_place = cutter.take_place();
  loads.treelet_place = cutter.take_place();
  loads.treelet = cutter.take_field<std::int32_t>();
  cutter.take_field<std::int32_t>();
  loads.leaf = cutter.take<TriangleRecord>(traversal_.tree.shape.leaf_records());
  loads.treelet_offset = cutter.take_field<std::uint64_t>().offset_bytes;
  return loads;
}

void TraverseStage::load(std::uint64_t step, int block) {
  state(step).rays = LaneMask::first(traversal_.bin.rays(block));
  TransferRing& records = traversal_.records;
  records.wait(step);
  records.wait_until(traversal_.bin.last_writer(block));
  const int bytes = traversal_.bin.record_bytes();
  records.copy_m2p(step, -1, {records.buffer(step).offset_bytes, bytes},
                   cn::MonoPlaces::array(traversal_.bin.address_of(block), std::uint64_t(bytes)),
                   state(step).rays);
  if (!context_.config.buffers_loads()) records.wait(step);
}

void TraverseStage::prepare(std::uint64_t step, int /*block*/) {
  traversal_.records.wait(step);
  const Loads to = loads(step);
  State& of_step = state(step);
  of_step.needs_leaf = LaneMask{};
  of_step.needs_treelet = LaneMask{};
  LocateArguments arguments;
  arguments.record = record(step);
  arguments.shape = traversal_.tree.shape;
  arguments.triangles = context_.layout.triangles.address;
  arguments.nodes = context_.layout.nodes.address;
  arguments.leaf_place = to.leaf_place;
  arguments.treelet_place = to.treelet_place;
  arguments.treelet = to.treelet;
  arguments.needs_leaf = &of_step.needs_leaf;
  arguments.needs_treelet = &of_step.needs_treelet;
  context_.machine.run(kernels().locate, arguments, of_step.rays);
  of_step.leaves = context_.machine.count(of_step.needs_leaf);
  const TreeShape& shape = traversal_.tree.shape;
  context_.loads.copy_m2p(
      step, -1, {to.leaf.span().offset_bytes, shape.leaf_records() * int{sizeof(TriangleRecord)}},
      context_.machine.places_in(to.leaf_place), of_step.needs_leaf);
  context_.loads.copy_m2p(step, -1, {to.treelet_offset, shape.treelet_bytes()},
                          context_.machine.places_in(to.treelet_place), of_step.needs_treelet);
  context_.counts.traversal.leaf_loads += std::uint64_t(of_step.leaves);
  context_.counts.traversal.treelet_loads += std::uint64_t(of_step.needs_treelet.count());
}

void TraverseStage::process(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const State& of_step = state(step);
  alive_ = LaneMask{};
  TraverseArguments arguments;
  arguments.record = record(step);
  arguments.leaf = from.leaf;
  arguments.treelet = from.treelet;
  arguments.tree = traversal_.tree;
  arguments.tree.treelet_offset = from.treelet_offset;
  arguments.reach = traversal_.reach;
  arguments.tests_leaves = of_step.leaves > 0;
  arguments.alive = &alive_;
  context_.machine.run(kernels().traverse[format()], arguments, of_step.rays);
  sort_out(step, of_step.rays, traversal_.bin.pass(block));
}

void RecallStage::load(std::uint64_t step, int block) {
  context_.saves.wait_until(traversal_.last_step);
  const Bins::Block& bin = bin_block(block);
  context_.loads.copy_m2p(step, block, {bin.surface_place.offset_bytes, sizeof(MonoAddress)},
                          block_of(context_.layout.surface_place_bin, block), bin.live);
}

void RecallStage::process(std::uint64_t, int block) {
  Bins::Block& bin = bin_block(block);
  bin.hit_something = LaneMask{};
  context_.machine.run(context_.kernels.traversal().recall,
                       RecallArguments{bin.surface_place, &bin.hit_something}, bin.live);
}

void TreeTraversal::begin_pass() {
  context_.begun = 0;
  context_.finished = 0;
}

}  // namespace path_tracer
