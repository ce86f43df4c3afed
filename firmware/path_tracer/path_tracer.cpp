#include "firmware/path_tracer/path_tracer.hpp"

#include <algorithm>

namespace path_tracer {
namespace {

/// Where unoptimised Cn keeps its locals; the stack lies at the low end of poly SRAM (SDK Reference
/// Manual 3.1, p. 163).
constexpr int kStackBytes = 1024;

int load_buffer_bytes(const ProgramConfig& config) {
  int bytes = std::max({RayStage::kLoadBytes, IntersectionStage::kLoadBytes, PathStage::kLoadBytes});
  if (config.program != Program::segments)
    bytes = std::max({bytes, LightStage::kLoadBytes, LightingStage::kLoadBytes});
  if (config.program == Program::full) bytes = std::max(bytes, RadianceStage::kLoadBytes);
  return bytes;
}

int save_buffer_bytes(const ProgramConfig& config) {
  int bytes = std::max({RayStage::kSaveBytes, PathStage::kSaveBytes, int{sizeof(ScatterRecord)}});
  if (config.program != Program::segments)
    bytes =
        std::max({bytes, IntersectionStage::kSaveBytes, LightStage::kSaveBytes, LightingStage::kSaveBytes});
  if (config.program == Program::full) bytes = std::max(bytes, RadianceStage::kSaveBytes);
  return bytes;
}

const ProgramConfig& valid(const ProgramConfig& config) {
  validate(config);
  return config;
}

/// Semaphores 0 and 1 are the host's; they are taken before any other.
cn::Machine& with_host_semaphores(cn::Machine& machine) {
  const cn::Semaphore ready = machine.allocate_semaphore("results ready");
  const cn::Semaphore free = machine.allocate_semaphore("results free");
  if (ready.index != HostSemaphores::kResultsReady.index || free.index != HostSemaphores::kResultsFree.index)
    throw cn::MachineFault(
        "the host's semaphores 0 and 1 are taken: a machine runs one program after a reset");
  machine.poly_memory().allocate("stack", kStackBytes);
  return machine;
}

Bins make_bins(cn::Machine& machine, int blocks) {
  Bins bins;
  const int places_bytes = static_cast<int>(sizeof(MonoAddress)) * blocks;
  BufferCutter surface_places(machine.poly_memory().allocate("surface places", places_bytes));
  BufferCutter light_places(machine.poly_memory().allocate("light places", places_bytes));
  for (int i = 0; i < blocks; ++i) {
    Bins::Block block;
    block.surface_place = surface_places.take_place();
    block.light_place = light_places.take_place();
    bins.blocks.push_back(block);
  }
  return bins;
}

std::unique_ptr<TransferRing> untimed_ring(cn::Machine& machine, const ProgramConfig& config,
                                           const char* name, int bytes) {
  if (config.program == Program::full) return nullptr;
  return std::make_unique<TransferRing>(machine, name, 1, bytes);
}

}  // namespace

PathTracer::PathTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                       const Layout& layout, const Work& work)
    : machine_(with_host_semaphores(machine)),
      kernels_(kernels),
      config_(valid(config)),
      layout_(layout),
      bins_(make_bins(machine, config.bin_blocks)),
      loads_(machine, "load buffer", config.load_buffers(), load_buffer_bytes(config)),
      saves_(machine, "save buffer", config.save_buffers(), save_buffer_bytes(config)),
      untimed_loads_(untimed_ring(machine, config, "untimed load buffer", RadianceStage::kLoadBytes)),
      untimed_saves_(untimed_ring(machine, config, "untimed save buffer", RadianceStage::kSaveBytes)),
      ray_stage_(context(), RayStage::Rays::segments),
      intersection_stage_(context()),
      light_stage_(context()),
      shadow_ray_stage_(context(), RayStage::Rays::shadow_rays),
      lighting_stage_(context()),
      path_stage_(context(), work),
      radiance_stage_({machine, kernels, config_, layout_, untimed_loads_ ? *untimed_loads_ : loads_,
                       untimed_saves_ ? *untimed_saves_ : saves_, bins_, counts_}) {}

void PathTracer::run(const Progress& progress) {
  fill_bins();
  for (issue_loads(); !loading_.empty(); issue_loads()) {
    if (progress && !progress(path_stage_.camera_rays().issued())) return;
    run_step();
  }
  announce_results();
  saves_.wait_until(next_step_);
  counts_.paths = path_stage_.camera_rays().issued();
  counts_.steps = next_step_;
}

void PathTracer::fill_bins() {
  for (int block = 0; block < config_.bin_blocks && path_stage_.camera_rays().remaining() > 0; ++block) {
    const std::uint64_t step = next_step_++;
    saves_.wait(step);
    path_stage_.fill(step, block);
    path_stage_.save(step, block);
    if (!config_.buffer_saves) saves_.wait(step);
    live_blocks_.push_back(block);
    plan(ray_stage_, block);
  }
  plan_pass();
}

/// The rest of a pass, once it is known which blocks are alive; the ray bin's steps are planned before.
void PathTracer::plan_pass() {
  const auto plan_blocks = [this](Stage& stage) {
    for (const int block : live_blocks_) plan(stage, block);
  };
  plan_blocks(intersection_stage_);
  if (config_.program != Program::segments) {
    plan_blocks(light_stage_);
    plan_blocks(shadow_ray_stage_);
    plan_blocks(lighting_stage_);
  }
  plan_blocks(path_stage_);
  path_steps_left_ = static_cast<int>(live_blocks_.size());
  counts_.blocks += live_blocks_.size();
  if (!live_blocks_.empty()) counts_.skipped_blocks += std::size_t(config_.bin_blocks) - live_blocks_.size();
  live_blocks_.clear();
}

/// Where the next step comes from: the bins, or radiance after every ray step as long as there is some. It
/// must be through before the pass goes on, because path steps overwrite the vertices. Nothing when that is
/// not known yet.
PathTracer::Steps* PathTracer::next_steps() {
  const bool ray_step_is_next = !bin_steps_.empty() && bin_steps_.front().stage == &ray_stage_;
  if (ray_step_is_next && (rays_before_radiance_ > 0 || radiance_steps_.empty())) return &bin_steps_;
  if (!radiance_steps_.empty()) return &radiance_steps_;
  return bin_steps_.empty() || list_steps_left_ > 0 ? nullptr : &bin_steps_;
}

/// A step's records come from earlier steps on the same block of the bins. Few live blocks bring the two so
/// close that the earlier one has not run yet. Radiance steps are only planned when what they read is there.
bool PathTracer::can_load(const Step& step) const {
  return is_radiance(step) || std::none_of(loading_.begin(), loading_.end(), [&](const Step& earlier) {
           return !is_radiance(earlier) && earlier.block == step.block;
         });
}

void PathTracer::issue_loads() {
  while (loading_.size() < std::size_t(config_.load_buffers())) {
    Steps* const steps = next_steps();
    if (steps == nullptr || !can_load(steps->front())) return;
    Step step = steps->front();
    steps->pop_front();
    step.number = next_step_++;
    step.stage->load(step.number, step.block);
    loading_.push_back(step);
    rays_before_radiance_ = is_radiance(step) ? 1 : rays_before_radiance_ - 1;
  }
}

void PathTracer::run_step() {
  const Step step = loading_.front();
  loading_.pop_front();
  loads_.wait(step.number);
  saves_.wait(step.number);
  step.stage->process(step.number, step.block);
  step.stage->save(step.number, step.block);
  if (!config_.buffer_saves) saves_.wait(step.number);

  if (step.stage == &path_stage_) {
    after_path_step(step.block);
  } else if (step.stage == &radiance_stage_.list()) {
    after_list_step(step.block);
  } else if (step.stage == &radiance_stage_.fold()) {
    last_result_step_ = step.number;
  }
}

void PathTracer::after_path_step(int block) {
  if (radiance_is_timed()) announce_results();
  if (bins_.blocks[std::size_t(block)].live_count > 0) {
    live_blocks_.push_back(block);
    plan(ray_stage_, block);
  }
  if (--path_steps_left_ > 0) return;
  if (radiance_is_timed()) {
    plan_radiance_of_pass();
  } else {
    run_untimed_radiance();
  }
  path_stage_.clear_finished();
  plan_pass();
}

/// The first list step waits for the saves of the last path step; some ray steps before it hide that.
void PathTracer::plan_radiance_of_pass() {
  results_records_ = path_stage_.finished_count();
  radiance_stage_.fold().set_results(layout_.results[results_half_]);
  const int width = machine_.num_pes();
  for (int block = 0; block * width < results_records_; ++block) {
    radiance_stage_.begin_block(block, std::min(width, results_records_ - block * width));
    plan_radiance(radiance_stage_.list(), block);
    ++list_steps_left_;
  }
  rays_before_radiance_ = config_.load_buffers();
}

void PathTracer::after_list_step(int block) {
  for (int load = radiance_stage_.loads(block) - 1; load >= 0; --load)
    plan_radiance(radiance_stage_.fold(), radiance_stage_.fold_block(block, load));
  --list_steps_left_;
}

/// Tells the host which half of the results it may read, and makes sure that the other half is free.
void PathTracer::announce_results() {
  if (results_records_ == 0) return;
  saves_.wait_until(last_result_step_);
  machine_.write_mono(layout_.results_header[results_half_], ResultsHeader{results_records_, 0});
  machine_.sem_signal(HostSemaphores::kResultsReady);
  results_records_ = 0;
  results_half_ = 1 - results_half_;
  if (++announcements_ > 1) machine_.sem_wait(HostSemaphores::kResultsFree);
}

/// Programs that leave out radiance are timed without it, as in the paper; the image is made all the same.
void PathTracer::run_untimed_radiance() {
  const cn::Untimed untimed(machine_);
  const int finished = path_stage_.finished_count();
  const int width = machine_.num_pes();
  const auto run = [&](Stage& stage, int block) {
    stage.load(0, block);
    untimed_loads_->wait(0);
    stage.process(0, block);
    stage.save(0, block);
    untimed_saves_->wait(0);
  };
  radiance_stage_.fold().set_results(layout_.results[results_half_]);
  for (int block = 0; block * width < finished; ++block) {
    radiance_stage_.begin_block(block, std::min(width, finished - block * width));
    run(radiance_stage_.list(), block);
    for (int load = radiance_stage_.loads(block) - 1; load >= 0; --load)
      run(radiance_stage_.fold(), radiance_stage_.fold_block(block, load));
  }
  results_records_ = finished;
  announce_results();
}

}  // namespace path_tracer
