#include "firmware/path_tracer/stages/stream_path_stage.hpp"

#include "firmware/path_tracer/kernels/stream_kernels.hpp"

namespace path_tracer {

StreamPathStage::StreamPathStage(const StageContext& context, RayStore& rays, const Work& work)
    : PathStage(context, rays, work),
      append_stage_(context, *this),
      place_of_block_(context.bins.blocks.size()) {}

void StreamPathStage::number_blocks(const std::vector<int>& blocks) {
  int place = 0;
  for (const int block : blocks) place_of_block_[std::size_t(block)] = place++;
}

cn::MonoPlaces StreamPathStage::number_places(int block) const {
  const std::uint64_t first = first_slot(place_of_block_[std::size_t(block)]);
  return cn::MonoPlaces::array((context_.layout.path_numbers + first).address, sizeof(PathNumbers));
}

StreamPathStage::Numbered StreamPathStage::numbered(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  cutter.take_bytes<PathRecord>(PathStage::load_bytes(context_.config));
  return {cutter.take<PathNumbers>(), cutter.take<FinishedRecord>()};
}

PolyPointer<PathNumbers> StreamPathStage::counted(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  cutter.take_bytes<PathRecord>(PathStage::save_bytes(context_.config));
  return cutter.take<PathNumbers>();
}

void StreamPathStage::load_to_append(std::uint64_t step, int block) {
  PathStage::load(step, block);
}

void StreamPathStage::append(std::uint64_t step, int block) {
  append_vertices(step, block);
  count_segments(block);
  context_.counts.folds += std::uint64_t(finished_.count() - ended_.count());
  Bins::Block& bin = bin_block(block);
  bin.ended = ended_;
  bin.finished = finished_;
  CountPathsArguments arguments;
  arguments.ended = &bin.ended;
  arguments.finished = &bin.finished;
  arguments.numbers = counted(step);
  context_.machine.run(context_.kernels.stream().count_paths, arguments, LaneMask::first(num_pes()));
}

/// An entry of the list is written for every path, in its slot: which are needed is known to the next kernel.
void StreamPathStage::save_appended(std::uint64_t step, int block) {
  save_vertices(step, block);
  save_block(step, block, context_.layout.finished_bin, finished_entry(step), appended_);
  context_.saves.copy_p2m(step, block, number_places(block), counted(step).span(),
                          LaneMask::first(num_pes()));
}

void StreamPathStage::take_numbers(const PathNumbers& total) {
  finished_count_ = total.finished;
  started_ = paths_to_start(total.ended);
}

void StreamPathStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const Bins::Block& bin = bin_block(block);
  load_paths(step, block, bin.ready());
  const Numbered to = numbered(step);
  context_.loads.copy_m2p(step, block, to.numbers.span(), number_places(block), bin.finished);
  load_block(step, block, to.finished, context_.layout.finished_bin, bin.finished);
}

void StreamPathStage::process(std::uint64_t step, int block) {
  Bins::Block& bin = bin_block(block);
  appended_ = bin.ready();
  ended_ = bin.ended;
  finished_ = bin.finished;
  const Numbered from = numbered(step);
  PackFinishedArguments arguments;
  arguments.numbers = from.numbers;
  arguments.entry = from.finished;
  arguments.packed = finished_entry(step);
  arguments.place = finished_place(step);
  arguments.list = context_.layout.finished.address;
  context_.machine.run(context_.kernels.stream().pack_finished, arguments, finished_);
  continue_paths(step, block, from.numbers.field(&PathNumbers::ended), started_);
  bin.ended = LaneMask{};
  bin.finished = LaneMask{};
  context_.machine.count(bin.live);  // the control unit leaves out blocks without a path
}

void StreamPathStage::save(std::uint64_t step, int block) {
  if (appended_.any()) save_finished(step, block);
  save_paths(step, block);
}

/// A PE's number in its block is that of its camera ray.
void StreamPathStage::fill(std::uint64_t step, int block) {
  appended_ = LaneMask::first(num_pes());
  ended_ = appended_;
  finished_ = LaneMask{};
  const PolyField<std::int32_t> number = numbered(step).numbers.field(&PathNumbers::ended);
  context_.machine.run(context_.kernels.stream().number_pes, NumberPesArguments{number}, appended_);
  const std::int32_t started = paths_to_start(num_pes());
  continue_paths(step, block, number, started);
  camera_rays_.issue(std::uint64_t(started));
  appended_ = LaneMask{};
}

}  // namespace path_tracer
