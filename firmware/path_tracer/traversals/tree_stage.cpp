#include "firmware/path_tracer/traversals/tree_stage.hpp"

#include <algorithm>

namespace path_tracer {

TreeContext::TreeContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout,
                         RayQueue& ray_queue)
    : queue(ray_queue), tree{config.tree, 0, 0}, reach(layout.reach) {
  const int bytes = tree.shape.resident_bytes();
  const cn::PolySpan resident = machine.poly_memory().allocate("resident nodes", bytes);
  tree.resident_offset = resident.offset_bytes;
  const cn::Semaphore done = machine.allocate_semaphore("resident nodes");
  machine.async_copy_m2p(done, resident, cn::MonoPlaces::array(layout.nodes.address, 0),
                         LaneMask::first(machine.num_pes()));
  machine.sem_wait(done);
}

int TreeStage::load_bytes(const TreeShape& shape, const Layers& layers) {
  return 4 * int{sizeof(MonoAddress)} + int{sizeof(QueuedRay)} +
         shape.leaf_records() * layers.record_bytes() + shape.treelet_bytes();
}

TreeStage::Loads TreeStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  Loads loads;
  loads.leaf_place = cutter.take_place();
  loads.treelet_place = cutter.take_place();
  loads.ray_place = cutter.take_place();
  loads.treelet = cutter.take_field<std::int32_t>();
  cutter.take_field<std::int32_t>();
  loads.ray = cutter.take<QueuedRay>();
  loads.leaf = cutter.take_bytes<TriangleRecord>(leaf_bytes());
  loads.treelet_offset = cutter.take_place().offset_bytes;
  return loads;
}

TreeStage::Hits TreeStage::hits(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  return {cutter.take_bytes<HitRecord>(context_.layout.sizes.hit), cutter.take_place(), cutter.take_place(),
          cutter.take_place()};
}

LaneMask TreeStage::packed_rays(int block) const {
  const int first = block * num_pes();
  return LaneMask::first(std::min(num_pes(), tree_.queue.rays() - first));
}

void TreeStage::load_packed_rays(std::uint64_t step, int block) {
  RayQueue& queue = tree_.queue;
  context_.saves.wait_until(queue.last_writer());
  const LaneMask rays = packed_rays(block);
  context_.loads.copy_m2p(step, TransferRing::kNoBlock, loads(step).ray.span(),
                          cn::MonoPlaces::array(queue.next_place(), sizeof(QueuedRay)), rays);
  queue.take(rays.count());
}

void TreeStage::locate(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays,
                       Needs& needs) {
  const Loads to = loads(step);
  needs = Needs{};
  LocateArguments arguments;
  arguments.record = record;
  arguments.shape = tree_.tree.shape;
  arguments.triangles = context_.layout.triangles.address;
  arguments.triangle_bytes = context_.layout.layers.record_bytes();
  arguments.nodes = context_.layout.nodes.address;
  arguments.leaf_place = to.leaf_place;
  arguments.treelet_place = to.treelet_place;
  arguments.treelet = to.treelet;
  arguments.needs_leaf = &needs.leaf;
  arguments.needs_treelet = &needs.treelet;
  context_.machine.run(kernels_.locate, arguments, rays);
}

void TreeStage::load_leaves(std::uint64_t step, Needs& needs) {
  const Loads to = loads(step);
  needs.leaves = context_.machine.count(needs.leaf);
  const cn::PolySpan leaf{to.leaf.span().offset_bytes, leaf_bytes()};
  context_.loads.copy_m2p(step, TransferRing::kNoBlock, leaf, context_.machine.places_in(to.leaf_place),
                          needs.leaf);
  context_.counts.traversal.leaf_loads += std::uint64_t(needs.leaves);
}

void TreeStage::load_treelets(std::uint64_t step, const Needs& needs) {
  const Loads to = loads(step);
  context_.loads.copy_m2p(step, TransferRing::kNoBlock, {to.treelet_offset, tree_.tree.shape.treelet_bytes()},
                          context_.machine.places_in(to.treelet_place), needs.treelet);
  context_.counts.traversal.treelet_loads += std::uint64_t(needs.treelet.count());
}

void TreeStage::load_tree(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays,
                          Needs& needs) {
  locate(step, record, rays, needs);
  load_leaves(step, needs);
  load_treelets(step, needs);
}

void TreeStage::enter(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays) {
  const Loads from = loads(step);
  EnterArguments arguments;
  arguments.ray = from.ray;
  arguments.first_light_run = context_.layout.triangle_count;
  arguments.record = record;
  arguments.treelet = from.treelet;
  context_.machine.run(kernels_.enter, arguments, rays);
}

LaneMask TreeStage::traverse(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays,
                             const Needs& needs) {
  const Loads from = loads(step);
  LaneMask alive;
  TraverseArguments arguments;
  arguments.record = record;
  arguments.leaf = from.leaf;
  arguments.treelet = from.treelet;
  arguments.tree = tree_.tree;
  arguments.tree.treelet_offset = from.treelet_offset;
  arguments.reach = tree_.reach;
  arguments.layers = context_.layout.layers;
  arguments.loaded_leaf = needs.leaves > 0 ? &needs.leaf : nullptr;
  arguments.alive = &alive;
  context_.machine.run(kernels_.traverse_through(tree_.tree.shape.layout), arguments, rays);
  return alive;
}

void TreeStage::finish(std::uint64_t step, PolyPointer<TraversalRecord> record, const LaneMask& rays) {
  finished_ = rays;
  tree_.finished += std::uint64_t(rays.count());
  if (!rays.any()) return;  // the control unit knows this from the count of remaining rays
  const Hits to = hits(step);
  FinishArguments arguments;
  arguments.record = record;
  arguments.surfaces = {context_.layout.surfaces.address, context_.layout.sizes.surface};
  arguments.hits = {context_.layout.intersection_bin.address, context_.layout.sizes.hit};
  arguments.hit_has_tail = context_.layout.sizes.hit_has_tail();
  arguments.surface_places = context_.layout.surface_place_bin.address;
  arguments.hit = to.hit;
  arguments.surface_place = to.surface_place;
  arguments.hit_to = to.hit_to;
  arguments.surface_place_to = to.surface_place_to;
  context_.machine.run(kernels_.finish, arguments, rays);
}

void TreeStage::save_hits(std::uint64_t step) {
  if (!finished_.any()) return;
  const Hits from = hits(step);
  context_.saves.copy_p2m(step, TransferRing::kNoBlock, context_.machine.places_in(from.hit_to),
                          with_tail(from.hit, context_.layout.sizes.hit), finished_);
  context_.saves.copy_p2m(step, TransferRing::kNoBlock, context_.machine.places_in(from.surface_place_to),
                          {from.surface_place.offset_bytes, sizeof(MonoAddress)}, finished_);
  tree_.last_hit_step = step;
}

/// Statistics of the simulator, as the next two functions; the chip does not count, so this is free.
void TreeStage::count_pass(std::size_t pass, const LaneMask& rays) {
  count_rays(pass, std::uint64_t(rays.count()));
  count_lanes(pass, rays);
}

void TreeStage::make_room_for_counts(std::size_t pass) {
  context_.counts.traversal.rays.resize(pass + 1);
  context_.counts.traversal.lanes.resize(pass + 1);
}

void TreeStage::count_lanes(std::size_t pass, const LaneMask& rays) {
  TraversalCounts& counts = context_.counts.traversal;
  const auto lanes = std::uint64_t(num_pes());
  counts.lanes[pass] += lanes;
  const auto in_bin = std::uint64_t(tree_.queue.rays());
  if (20 * tree_.finished >= 19 * in_bin) return;
  counts.rays_before_tail += std::uint64_t(rays.count());
  counts.lanes_before_tail += lanes;
}

void RecallStage::load(std::uint64_t step, int block) {
  context_.saves.wait_until(last_writer_(block));
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

}  // namespace path_tracer
