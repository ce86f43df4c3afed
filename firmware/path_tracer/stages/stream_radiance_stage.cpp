#include "firmware/path_tracer/stages/stream_radiance_stage.hpp"

#include <algorithm>

namespace path_tracer {
namespace {

constexpr int kLoadBytes = kVerticesPerLoad * int{sizeof(VertexRecord)};
constexpr int kPathBytes = 2 * int{sizeof(MonoAddress)} + 4 * int{sizeof(std::int32_t)};

}  // namespace

StreamRadianceStage::StreamRadianceStage(const StageContext& context, int load_buffers)
    : Stage(context),
      load_buffers_(std::uint64_t(load_buffers)),
      loads_per_path_(context.config.slot_vertices / kVerticesPerLoad),
      states_(load_buffers_) {}

int StreamRadianceStage::load_bytes(const ProgramConfig& config) {
  return int{sizeof(FinishedRecord)} + kPathBytes + 2 * int{sizeof(FoldRecord)} +
         config.slot_vertices * int{sizeof(VertexRecord)};
}

StreamRadianceStage::Loads StreamRadianceStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  Loads loads;
  loads.entry = cutter.take<FinishedRecord>();
  loads.path.vertex_place = cutter.take_place();
  loads.path.fold_place = cutter.take_place();
  for (PolyField<std::int32_t>* const field : {&loads.path.vertices, &loads.path.pixel, &loads.path.sample})
    *field = cutter.take_field<std::int32_t>();
  cutter.take_field<std::int32_t>();
  loads.earlier = cutter.take<FoldRecord>();
  loads.sum = cutter.take<FoldRecord>();
  loads.vertices = cutter.take<VertexRecord>(context_.config.slot_vertices);
  return loads;
}

StreamRadianceStage::Saves StreamRadianceStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  return {cutter.take<RadianceRecord>(), cutter.take<FoldRecord>()};
}

LaneMask StreamRadianceStage::entries(int block) const {
  return LaneMask::first(std::min(num_pes(), entries_ - block * num_pes()));
}

/// The save of the step that had the buffer before takes places from it.
void StreamRadianceStage::load(std::uint64_t step, int block) {
  if (step >= load_buffers_) context_.saves.wait_until(step - load_buffers_);
  load_block(step, block, loads(step).entry, context_.layout.finished, entries(block));
}

void StreamRadianceStage::find_vertices(std::uint64_t step, int block) {
  State& found = state(step);
  found.needs_load.assign(std::size_t(loads_per_path_), LaneMask{});
  found.folded = LaneMask{};
  found.flushed = LaneMask{};
  ListArguments arguments;
  arguments.entry = loads(step).entry;
  arguments.vertices = context_.layout.vertices.address;
  arguments.folds = context_.layout.folds.address;
  arguments.slot_vertices = context_.config.slot_vertices;
  arguments.path = loads(step).path;
  arguments.needs_load = found.needs_load.data();
  arguments.folded = &found.folded;
  arguments.flushed = &found.flushed;
  context_.machine.run(context_.kernels.list, arguments, entries(block));
  found.any_partial = context_.machine.count(found.folded.with(found.flushed)) > 0;
  found.loads = 0;
  for (const LaneMask& needed : found.needs_load) {
    if (context_.machine.count(needed) == 0) break;
    ++found.loads;
  }
}

void StreamRadianceStage::prepare(std::uint64_t step, int block) {
  context_.loads.wait(step);
  find_vertices(step, block);
  const State& found = state(step);
  const Loads to = loads(step);
  if (found.any_partial)
    context_.loads.copy_m2p(step, block, to.earlier.span(), context_.machine.places_in(to.path.fold_place),
                            found.folded);
  for (int load = 0; load < found.loads; ++load)
    context_.loads.copy_m2p(
        step, block, {to.vertices[load * kVerticesPerLoad].span().offset_bytes, kLoadBytes},
        context_.machine.places_in(to.path.vertex_place, std::uint64_t(load) * std::uint64_t{kLoadBytes}),
        found.needs_load[std::size_t(load)]);
}

void StreamRadianceStage::process(std::uint64_t step, int block) {
  const State& found = state(step);
  const Loads from = loads(step);
  const Saves to = saves(step);
  FoldArguments arguments;
  arguments.path = from.path;
  arguments.folded = found.any_partial ? &found.folded : nullptr;
  arguments.earlier = from.earlier;
  arguments.sum = from.sum;
  arguments.radiance = to.radiance;
  arguments.flushed = to.flushed;
  for (int load = found.loads - 1; load >= 0; --load) {
    arguments.starts = load + 1 == found.loads;
    arguments.first_vertex = load * kVerticesPerLoad;
    arguments.vertices = from.vertices[load * kVerticesPerLoad];
    context_.machine.run(context_.kernels.fold, arguments, entries(block));
  }
}

void StreamRadianceStage::save(std::uint64_t step, int block) {
  const Saves from = saves(step);
  save_block(step, block, results_, from.radiance, entries(block));
  if (!state(step).any_partial) return;
  context_.saves.copy_p2m(step, block, context_.machine.places_in(loads(step).path.fold_place),
                          from.flushed.span(), state(step).flushed);
}

}  // namespace path_tracer
