#include "firmware/path_tracer/stages/radiance_stage.hpp"

namespace path_tracer {

RadianceStage::RadianceStage(const StageContext& context)
    : loads_per_path_(context.config.slot_vertices / kVerticesPerLoad),
      list_(context, blocks_),
      fold_(context, blocks_) {
  cn::PolyMemory& memory = context.machine.poly_memory();
  constexpr int kPathBytes = 2 * sizeof(MonoAddress) + 4 * sizeof(std::int32_t);
  BufferCutter paths(memory.allocate("finished paths", kPathBytes * kBlocksUnderWay));
  for (ListBlock& block : blocks_) {
    block.path.vertex_place = paths.take_place();
    block.path.fold_place = paths.take_place();
    block.path.vertices = paths.take_field<std::int32_t>();
    block.path.pixel = paths.take_field<std::int32_t>();
    block.path.sample = paths.take_field<std::int32_t>();
    paths.take_field<std::int32_t>();
    block.needs_load.resize(std::size_t(loads_per_path_));
  }
}

void RadianceStage::ListStage::load(std::uint64_t step, int block) {
  const PolyPointer<FinishedRecord> entry(context_.loads.buffer(step));
  load_block(step, block, entry, context_.layout.finished, LaneMask::first(blocks_[block].entries));
}

void RadianceStage::ListStage::process(std::uint64_t step, int block) {
  ListBlock& list = blocks_[block];
  list.needs_load.assign(list.needs_load.size(), LaneMask{});
  list.folded = LaneMask{};
  list.flushed = LaneMask{};
  ListArguments arguments;
  arguments.entry = PolyPointer<FinishedRecord>(context_.loads.buffer(step));
  arguments.vertices = context_.layout.vertices.address;
  arguments.folds = context_.layout.folds.address;
  arguments.slot_vertices = context_.config.slot_vertices;
  arguments.path = list.path;
  arguments.needs_load = list.needs_load.data();
  arguments.folded = &list.folded;
  arguments.flushed = &list.flushed;
  context_.machine.run(context_.kernels.list, arguments, LaneMask::first(list.entries));
  list.any_partial = context_.machine.count(list.folded.with(list.flushed)) > 0;
  list.loads = 0;
  for (const LaneMask& needed : list.needs_load) {
    if (context_.machine.count(needed) == 0) break;
    ++list.loads;
  }
}

RadianceStage::FoldStage::FoldStage(const StageContext& context, ListBlocks& blocks)
    : Stage(context),
      blocks_(blocks),
      loads_per_path_(context.config.slot_vertices / kVerticesPerLoad),
      sum_(context.machine.poly_memory().allocate("radiance sum", sizeof(FoldRecord))) {}

RadianceStage::FoldStage::Loads RadianceStage::FoldStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  return {cutter.take<FoldRecord>(), cutter.take<VertexRecord>(kVerticesPerLoad)};
}

RadianceStage::FoldStage::Saves RadianceStage::FoldStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  return {cutter.take<RadianceRecord>(), cutter.take<FoldRecord>()};
}

void RadianceStage::FoldStage::load(std::uint64_t step, int block) {
  const Loads to = loads(step);
  const ListBlock& list = list_block(block);
  const int load = load_of(block);
  if (is_last(block) && list.any_partial)
    context_.loads.copy_m2p(step, block, to.earlier.span(), context_.machine.places_in(list.path.fold_place),
                            list.folded);
  constexpr int kBytes = kVerticesPerLoad * static_cast<int>(sizeof(VertexRecord));
  context_.loads.copy_m2p(step, block, {to.vertices.span().offset_bytes, kBytes},
                          context_.machine.places_in(list.path.vertex_place, std::uint64_t(load) * kBytes),
                          list.needs_load[std::size_t(load)]);
}

void RadianceStage::FoldStage::process(std::uint64_t step, int block) {
  const Loads from = loads(step);
  const Saves to = saves(step);
  const ListBlock& list = list_block(block);
  FoldArguments arguments;
  arguments.path = list.path;
  arguments.vertices = from.vertices;
  arguments.first_vertex = load_of(block) * kVerticesPerLoad;
  arguments.starts = is_first(block);
  arguments.folded = list.any_partial ? &list.folded : nullptr;
  arguments.earlier = from.earlier;
  arguments.sum = PolyPointer<FoldRecord>(sum_);
  arguments.radiance = to.radiance;
  arguments.flushed = to.flushed;
  context_.machine.run(context_.kernels.fold, arguments, LaneMask::first(list.entries));
}

void RadianceStage::FoldStage::save(std::uint64_t step, int block) {
  if (!is_last(block)) return;
  const ListBlock& list = list_block(block);
  const Saves from = saves(step);
  context_.saves.copy_p2m(step, block, block_of(results_, list_index(block)), from.radiance.span(),
                          LaneMask::first(list.entries));
  if (!list.any_partial) return;
  context_.saves.copy_p2m(step, block, context_.machine.places_in(list.path.fold_place), from.flushed.span(),
                          list.flushed);
}

}  // namespace path_tracer
