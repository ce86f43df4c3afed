#include "firmware/path_tracer/path_tracer.hpp"

#include <algorithm>

#include "firmware/path_tracer/traversals/search_choice.hpp"

namespace path_tracer {
namespace {

int load_buffer_bytes(const ProgramConfig& config) {
  return std::max(IntersectionStage::load_bytes(config), PathStage::load_bytes(config));
}

int save_buffer_bytes(const ProgramConfig& config) {
  return std::max({IntersectionStage::save_bytes(config), PathStage::save_bytes(config),
                   config.bins_hits() ? BinnedIntersectionStage::save_bytes(config) : 0});
}

}  // namespace

Rings PathTracer::make_radiance_rings(cn::Machine& machine, const ProgramConfig& config) {
  return {{machine,
           "radiance load buffer",
           {PassRadiance::load_buffers(config), RadianceStage::kLoadBytes, !config.buffers_loads()}},
          {machine, "radiance save buffer", {1, RadianceStage::kSaveBytes, !config.buffers_saves()}}};
}

PathTracer::PathTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                       const Layout& layout, const Work& work)
    : machine_(with_semaphores_and_stack(machine)),
      kernels_(kernels),
      config_(built_for(layout, config)),
      layout_(layout),
      bins_(make_bins(machine.poly_memory(), config_.bin_blocks)),
      rings_(make_rings(machine, config_, layout.layers, load_buffer_bytes(config_),
                        save_buffer_bytes(config_))),
      radiance_rings_(make_radiance_rings(machine, config_)),
      scratchpad_(machine, rings_.loads, config_.scratchpad, layout_),
      search_(make_search(context(rings_))),
      intersection_stage_(context(rings_), search_->rays()),
      hit_binning_(config_.bins_hits() ? std::make_unique<HitBinning>(context(rings_), search_->rays())
                                       : nullptr),
      path_stage_(context(rings_), search_->rays(), work),
      steps_(machine, {rings_.loads, rings_.saves, config_.load_buffers()}),
      radiance_(context(radiance_rings_), rings_.saves) {}

void PathTracer::run(const Progress& progress) {
  fill_bins();
  begin_pass();
  while (true) {
    steps_.load_ahead();
    if (radiance_.is_left() && !next_is_ray_step()) radiance_.run_to_end();
    if (steps_.next() == nullptr) break;
    if (progress && !progress(path_stage_.camera_rays().issued())) return;
    run_next_step();
  }
  radiance_.announce_results();
  steps_.wait_for_saves();
  counts_.paths = path_stage_.camera_rays().issued();
  counts_.steps = steps_.steps() + radiance_.steps();
}

void PathTracer::fill_bins() {
  for (int block = 0; block < config_.bin_blocks && path_stage_.camera_rays().remaining() > 0; ++block) {
    steps_.run_without_loads(path_stage_, block, [&](std::uint64_t step) { path_stage_.fill(step, block); });
    report_fill(block);
    take_into_next_pass(block);
  }
}

void PathTracer::run_next_step() {
  const bool is_ray_step = next_is_ray_step();
  if (is_ray_step) radiance_.before_ray_step();
  const Step step = steps_.run_next();
  if (step.stage == &path_stage_) after_path_step(step);
  if (hit_binning_ && hit_binning_->after_step(steps_, step, pass_.blocks())) plan_path_stage();
  if (!is_ray_step) return;
  if (search_->after_step(steps_, step, pass_.blocks())) plan_after_search();
  radiance_.after_ray_step();
}

void PathTracer::after_path_step(const Step& step) {
  radiance_.announce_timed_results();
  report_fill(step.block);
  if (bins_.blocks[std::size_t(step.block)].live.any()) take_into_next_pass(step.block);
  if (!pass_.ends_with_this_path_step()) return;
  radiance_.begin(path_stage_.finished_count(), step.number);
  path_stage_.clear_finished();
  begin_pass();
}

void PathTracer::take_into_next_pass(int block) {
  pass_.add_to_next(block);
  search_->add_block(steps_, block);
}

void PathTracer::take_empty_blocks() {
  for (int block = 0; block < config_.bin_blocks; ++block)
    if (!bins_.blocks[std::size_t(block)].live.any()) take_into_next_pass(block);
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
  for (const int block : pass_.blocks()) steps_.plan(path_stage_, block);
}

void PathTracer::report_fill(int block) {
  machine_.report_fill(block, bins_.blocks[std::size_t(block)].live);
}

}  // namespace path_tracer
