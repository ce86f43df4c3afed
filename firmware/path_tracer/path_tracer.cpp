#include "firmware/path_tracer/path_tracer.hpp"

#include <algorithm>

#include "firmware/path_tracer/traversals/search_choice.hpp"

namespace path_tracer {
namespace {

int load_buffer_bytes(const ProgramConfig& config) {
  return std::max(
      {IntersectionStage::load_bytes(config), PathStage::load_bytes(config),
       config.is_stream() ? std::max(StreamPathStage::load_bytes(config), ScanStage::kLoadBytes) : 0});
}

int save_buffer_bytes(const ProgramConfig& config) {
  return std::max(
      {IntersectionStage::save_bytes(config), PathStage::save_bytes(config),
       config.is_stream() ? std::max(StreamPathStage::save_bytes(config), ScanStage::kSaveBytes) : 0,
       config.bins_hits() ? BinnedIntersectionStage::save_bytes(config) : 0});
}

std::unique_ptr<PathStage> make_path_stage(const StageContext& context, RayStore& rays, const Work& work) {
  if (context.config.is_stream()) return std::make_unique<StreamPathStage>(context, rays, work);
  return std::make_unique<PathStage>(context, rays, work);
}

std::unique_ptr<StreamPaths> make_stream_paths(const StageContext& context, PathStage& paths) {
  if (!context.config.is_stream()) return nullptr;
  return std::make_unique<StreamPaths>(context, static_cast<StreamPathStage&>(paths));
}

std::unique_ptr<SlotStates> make_slot_states(const StageContext& context) {
  if (!context.config.is_stream()) return nullptr;
  return std::make_unique<SlotStates>(context);
}

}  // namespace

Rings PathTracer::make_radiance_rings(cn::Machine& machine, const ProgramConfig& config) {
  return {{machine,
           "radiance load buffer",
           {PassRadiance::load_buffers(config), PassRadiance::load_bytes(config), !config.buffers_loads()}},
          {machine, "radiance save buffer", {1, RadianceStage::kSaveBytes, !config.buffers_saves()}}};
}

PathTracer::PathTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                       const Layout& layout, const Work& work)
    : machine_(with_semaphores_and_stack(machine)),
      kernels_(kernels),
      config_(built_for(layout, config)),
      layout_(layout),
      bins_(make_bins(machine.poly_memory(), config_)),
      rings_(make_rings(machine, config_, layout.layers, load_buffer_bytes(config_),
                        save_buffer_bytes(config_))),
      radiance_rings_(make_radiance_rings(machine, config_)),
      scratchpad_(machine, rings_.loads, config_.scratchpad, layout_),
      search_(make_search(context(rings_), layout_)),
      intersection_stage_(context(rings_), search_->rays()),
      hit_binning_(config_.bins_hits() ? std::make_unique<HitBinning>(context(rings_), search_->rays())
                                       : nullptr),
      path_stage_(make_path_stage(context(rings_), search_->rays(), work)),
      stream_paths_(make_stream_paths(context(rings_), *path_stage_)),
      slot_states_(make_slot_states(context(rings_))),
      steps_(machine, {rings_.loads, rings_.saves, config_.load_buffers(), slot_states_.get()}),
      radiance_(context(radiance_rings_), rings_.saves) {}

void PathTracer::run(const Progress& progress) {
  fill_bins();
  begin_pass();
  while (true) {
    steps_.load_ahead();
    if (radiance_.is_left() && !next_is_ray_step()) radiance_.run_to_end();
    if (steps_.next() == nullptr) break;
    if (progress && !progress(path_stage_->camera_rays().issued())) path_stage_->stop_camera_rays();
    run_next_step();
  }
  radiance_.announce_results();
  steps_.wait_for_saves();
  counts_.paths = path_stage_->camera_rays().issued();
  counts_.steps = steps_.steps() + radiance_.steps();
}

/// Blocks for which no camera ray is left stay empty. In stream execution, if they take part, their slots
/// need a state that says so.
void PathTracer::fill_bins() {
  const bool takes_empty_blocks = config_.is_stream() && !config_.skips_empty_blocks;
  for (int block = 0; block < config_.bin_blocks; ++block) {
    if (path_stage_->camera_rays().remaining() == 0 && !takes_empty_blocks) break;
    steps_.run_without_loads(*path_stage_, block,
                             [&](std::uint64_t step) { path_stage_->fill(step, block); });
    report_fill(block);
    if (bins_.blocks[std::size_t(block)].has_rays()) take_into_next_pass(block);
  }
}

void PathTracer::run_next_step() {
  const bool is_ray_step = next_is_ray_step();
  if (is_ray_step) radiance_.before_ray_step();
  const Step step = steps_.run_next();
  if (stream_paths_) stream_paths_->after_step(steps_, step, pass_.blocks());
  if (step.stage == path_stage_.get()) after_path_step(step);
  if (hit_binning_ && hit_binning_->after_step(steps_, step, pass_.blocks())) plan_path_stage();
  if (!is_ray_step) return;
  if (search_->after_step(steps_, step, pass_.blocks())) plan_after_search();
  radiance_.after_ray_step();
}

void PathTracer::after_path_step(const Step& step) {
  radiance_.announce_timed_results();
  report_fill(step.block);
  if (bins_.blocks[std::size_t(step.block)].has_rays()) take_into_next_pass(step.block);
  if (!pass_.ends_with_this_path_step()) return;
  radiance_.begin(path_stage_->finished_count(), step.number);
  path_stage_->clear_finished();
  begin_pass();
}

void PathTracer::take_into_next_pass(int block) {
  pass_.add_to_next(block);
  search_->add_block(steps_, block);
}

void PathTracer::take_empty_blocks() {
  for (int block = 0; block < config_.bin_blocks; ++block)
    if (!bins_.blocks[std::size_t(block)].has_rays()) take_into_next_pass(block);
}

void PathTracer::begin_pass() {
  if (!config_.skips_empty_blocks && pass_.has_next()) take_empty_blocks();
  pass_.begin();
  count_pass(pass_.blocks(), bins_, counts_);
  if (search_->begin_pass(steps_, pass_.blocks())) plan_after_search();
}

void PathTracer::plan_after_search() {
  if (hit_binning_) return hit_binning_->begin_pass(steps_, pass_.blocks());
  for (const int block : pass_.blocks()) steps_.plan(intersection_stage_, block);
  plan_path_stage();
}

void PathTracer::plan_path_stage() {
  if (stream_paths_) return stream_paths_->begin_pass(steps_, pass_.blocks());
  for (const int block : pass_.blocks()) steps_.plan(*path_stage_, block);
}

void PathTracer::report_fill(int block) {
  machine_.report_fill(block, bins_.blocks[std::size_t(block)].live);
}

}  // namespace path_tracer
