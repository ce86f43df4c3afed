#include "firmware/path_tracer/stages/path_stage.hpp"

#include <algorithm>

namespace path_tracer {

PathStage::PathStage(const StageContext& context, RayStore& rays, const Work& work)
    : Stage(context),
      rays_(rays),
      camera_rays_(work,
                   [&] {
                     const CameraRecord& camera = *context.machine.read_mono(context.layout.camera);
                     return camera.width * camera.height;
                   }()),
      is_listed_(work.listed_samples > 0),
      number_{context.machine.poly_memory().allocate("ascending numbers", sizeof(std::int32_t)).offset_bytes},
      segments_(std::size_t(context.config.bin_blocks) * std::size_t(context.machine.num_pes())) {
  require_pixel_stride(context.config.pixel_stride, camera_rays_.pixels());
}

PathStage::Loads PathStage::loads(std::uint64_t step) const {
  BufferCutter cutter(context_.loads.buffer(step));
  const RecordSizes& sizes = context_.layout.sizes;
  return {cutter.take_bytes<PathRecord>(sizes.path), cutter.take_bytes<ScatterRecord>(sizes.scatter),
          cutter.take<DirectLightRecord>()};
}

PathStage::Saves PathStage::saves(std::uint64_t step) const {
  BufferCutter cutter(context_.saves.buffer(step));
  return {cutter.take<VertexRecord>(),   cutter.take_bytes<PathRecord>(context_.layout.sizes.path),
          cutter.take<FinishedRecord>(), cutter.take_place(),
          cutter.take_place(),           rays_.take_room(cutter)};
}

void PathStage::load(std::uint64_t step, int block) {
  context_.saves.wait_block(block);
  const Bins::Block& bin = bin_block(block);
  load_paths(step, block, bin.ready());
  if (context_.config.casts_shadow_rays())
    load_block(step, block, loads(step).direct_light, context_.layout.direct_light_bin, bin.ended_shadow());
}

void PathStage::load_paths(std::uint64_t step, int block, const LaneMask& enabled) {
  const Loads to = loads(step);
  const RecordSizes& sizes = context_.layout.sizes;
  load_block(step, block, to.path, context_.layout.path_bin, enabled, sizes.path);
  load_block(step, block, to.scatter, context_.layout.scatter_bin, enabled, sizes.scatter);
}

void PathStage::process(std::uint64_t step, int block) {
  append_vertices(step, block);
  count_segments(block);
  const int ended_count = context_.machine.count(ended_);
  list_finished(step);
  if (!(finished_ == ended_)) {
    context_.machine.number_ascending(ended_, number_);
    context_.counts.folds += std::uint64_t(finished_.count() - ended_count);
  }
  const std::int32_t started = paths_to_start(ended_count);
  continue_paths(step, block, number_, started);
  camera_rays_.issue(std::uint64_t(started));
}

void PathStage::append_vertices(std::uint64_t step, int block) {
  const Bins::Block& bin = bin_block(block);
  const Loads from = loads(step);
  const Saves to = saves(step);
  appended_ = bin.ready();
  ended_ = LaneMask{};
  finished_ = LaneMask{};
  AppendArguments arguments;
  arguments.path = from.path;
  arguments.scatter = from.scatter;
  arguments.direct_light = from.direct_light;
  arguments.has_direct_light = &bin.shadow;
  arguments.slot_vertices = context_.config.slot_vertices;
  arguments.first_slot = static_cast<int>(first_slot(block));
  arguments.block_vertices =
      (context_.layout.vertices + first_slot(block) * std::uint64_t(arguments.slot_vertices)).address;
  arguments.vertex = to.vertex;
  arguments.vertex_place = to.vertex_place;
  arguments.finished_record = to.finished;
  arguments.ended = &ended_;
  arguments.finished = &finished_;
  context_.machine.run(context_.kernels.append, arguments, appended_);
}

/// Statistics of the simulator; the chip does not count, so this is free.
void PathStage::count_segments(int block) {
  std::uint32_t* const of_block = &segments_[std::size_t(first_slot(block))];
  std::vector<std::uint64_t>& paths = context_.counts.paths_by_segments;
  for (int strip = 0; strip < num_pes() / cn::kStripLanes; ++strip) {
    std::uint32_t* const of_strip = of_block + strip * cn::kStripLanes;
    const std::uint32_t appended = appended_.strip_bits(strip);
    for (int i = 0; i < cn::kStripLanes; ++i) of_strip[i] += (appended >> i) & 1;
    for (std::uint32_t ended = ended_.strip_bits(strip); ended != 0; ended &= ended - 1) {
      std::uint32_t& segments = of_strip[__builtin_ctz(ended)];
      if (segments >= paths.size()) paths.resize(segments + 1);
      ++paths[segments];
      segments = 0;
    }
  }
}

void PathStage::list_finished(std::uint64_t step) {
  const int count = context_.machine.number_ascending(finished_, number_);
  NumberedPlaceArguments arguments;
  arguments.number = number_;
  arguments.records = {(context_.layout.finished + std::uint64_t(finished_count_)).address,
                       int{sizeof(FinishedRecord)}};
  arguments.place = saves(step).finished_place;
  context_.machine.run(context_.kernels.finished_place, arguments, finished_);
  finished_count_ += count;
}

/// Gathers the list's entries for the paths that start, straight to where their records are made. The step
/// waits for them: which slots start a path is known no earlier. Their places lie where the rays will.
void PathStage::load_listed(std::uint64_t step, int block, PolyField<std::int32_t> number,
                            std::int32_t started) {
  const Saves to = saves(step);
  LaneMask starts;
  ListedSampleArguments arguments;
  arguments.number = number;
  arguments.started = started;
  arguments.next_listed = (context_.layout.camera_samples + camera_rays_.issued()).address;
  arguments.place = PolyField<MonoAddress>{to.ray.ray.span().offset_bytes};
  arguments.starts = &starts;
  context_.machine.run(context_.kernels.listed_sample, arguments, ended_);
  context_.loads.copy_m2p(step, block, with_tail(to.path, int{sizeof(CameraSampleRecord)}),
                          context_.machine.places_in(arguments.place), starts);
  context_.loads.wait(step);
}

void PathStage::continue_paths(std::uint64_t step, int block, PolyField<std::int32_t> number,
                               std::int32_t started) {
  Bins::Block& bin = bin_block(block);
  const Loads from = loads(step);
  const Saves to = saves(step);
  if (is_listed_ && started > 0) load_listed(step, block, number, started);
  continued_ = LaneMask{};
  ContinuePathsArguments arguments;
  arguments.path = from.path;
  arguments.scatter = from.scatter;
  arguments.number = number;
  arguments.ended = &ended_;
  arguments.finished = &finished_;
  arguments.camera = context_.machine.read_mono(context_.layout.camera);
  if (context_.config.casts_shadow_rays() && !context_.config.resamples_lights()) {
    arguments.light_table = read_light_table(context_.machine, context_.layout);
    arguments.lights = context_.layout.lights.address;
    arguments.light_place = bin.light_place;
  }
  arguments.sampler = context_.config.sampler;
  arguments.seed = context_.config.seed;
  arguments.camera_rays = {camera_rays_.next_pixel(), camera_rays_.next_sample(),
                           context_.config.pixel_stride % camera_rays_.pixels()};
  arguments.is_listed = is_listed_;
  arguments.remaining = started;
  arguments.next_path = to.path;
  arguments.path_has_tail = context_.layout.sizes.path_has_tail();
  arguments.has_passed = context_.layout.sizes.has_passed;
  arguments.ray = to.ray.ray;
  arguments.live = &continued_;
  context_.machine.run(context_.kernels.continue_paths, arguments, appended_);
  bin.live = continued_.with(bin.casts);
  bin.shadow = bin.casts;
  bin.count_rays();
}

void PathStage::fill(std::uint64_t step, int block) {
  appended_ = LaneMask::first(num_pes());
  ended_ = appended_;
  finished_ = LaneMask{};
  const std::int32_t started = paths_to_start(context_.machine.number_ascending(ended_, number_));
  continue_paths(step, block, number_, started);
  camera_rays_.issue(std::uint64_t(started));
  appended_ = LaneMask{};
}

void PathStage::save(std::uint64_t step, int block) {
  if (appended_.any()) {
    save_vertices(step, block);
    save_finished(step, block);
  }
  save_paths(step, block);
}

void PathStage::save_vertices(std::uint64_t step, int block) {
  const Saves from = saves(step);
  context_.saves.copy_p2m(step, block, context_.machine.places_in(from.vertex_place), from.vertex.span(),
                          appended_);
}

void PathStage::save_finished(std::uint64_t step, int block) {
  context_.saves.copy_p2m(step, block, context_.machine.places_in(finished_place(step)),
                          finished_entry(step).span(), finished_);
}

void PathStage::save_paths(std::uint64_t step, int block) {
  const Saves from = saves(step);
  save_block(step, block, context_.layout.path_bin, from.path, continued_, context_.layout.sizes.path);
  rays_.save(context_.saves, step, {block}, from.ray, bin_block(block).light_place, continued_);
}

}  // namespace path_tracer
