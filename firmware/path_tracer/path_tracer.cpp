#include "firmware/path_tracer/path_tracer.hpp"

#include <algorithm>

#include "firmware/path_tracer/traversals/packet_stage.hpp"
#include "firmware/path_tracer/traversals/refill.hpp"
#include "firmware/path_tracer/traversals/shared_treelets.hpp"
#include "firmware/path_tracer/traversals/temporary_bin.hpp"

namespace path_tracer {
namespace {

/// Where unoptimised Cn keeps its locals; the stack lies at the low end of poly SRAM (SDK Reference
/// Manual 3.1, p. 163).
constexpr int kStackBytes = 1024;

int load_buffer_bytes(const ProgramConfig& config) {
  return std::max({RayStage::kLoadBytes, IntersectionStage::load_bytes(config.program), PathStage::kLoadBytes,
                   config.uses_tree() ? TreeStage::load_bytes(config.tree) : 0});
}

int save_buffer_bytes(const ProgramConfig& config) {
  return std::max({RayStage::kSaveBytes, IntersectionStage::save_bytes(config), PathStage::save_bytes(config),
                   config.uses_tree() ? TreeStage::kSaveBytes : 0});
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

/// A block of finished paths takes about three steps and two blocks of the ray bin bring one, so that two
/// steps between ray steps are enough.
int radiance_buffers(const ProgramConfig& config) {
  return config.program == Program::full && config.buffers_loads() ? 2 : 1;
}

std::optional<RayQueue> make_queue(cn::Machine& machine, const Kernels& kernels, const Layout& layout,
                                   const ProgramConfig& config) {
  if (!config.uses_tree()) return {};
  return RayQueue(machine, kernels, layout);
}

std::optional<TreeContext> make_tree_context(cn::Machine& machine, const Layout& layout,
                                             const ProgramConfig& config) {
  if (!config.uses_tree()) return {};
  return TreeContext(machine, config, layout);
}

std::unique_ptr<TreeTraversal> make_tree(const StageContext& context, TreeContext& tree) {
  if (context.config.traversal == Traversal::temporary_bin)
    return std::make_unique<TemporaryBinTraversal>(context, tree);
  if (context.config.traversal == Traversal::packets) return std::make_unique<PacketTraversal>(context, tree);
  if (context.config.traversal == Traversal::shared_treelets)
    return std::make_unique<SharedTreeletTraversal>(context, tree);
  return std::make_unique<RefillTraversal>(context, tree);
}

}  // namespace

PathTracer::PathTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                       const Layout& layout, const Work& work)
    : machine_(with_host_semaphores(machine)),
      kernels_(kernels),
      config_(valid(config)),
      layout_(layout),
      bins_(make_bins(machine, config.bin_blocks)),
      loads_(machine, "load buffer",
             {config.load_buffers(), load_buffer_bytes(config), !config.buffers_loads()}),
      saves_(machine, "save buffer",
             {config.save_buffers(), save_buffer_bytes(config), !config.buffers_saves()}),
      radiance_loads_(machine, "radiance load buffer",
                      {radiance_buffers(config), RadianceStage::kLoadBytes, !config.buffers_loads()}),
      radiance_saves_(machine, "radiance save buffer",
                      {1, RadianceStage::kSaveBytes, !config.buffers_saves()}),
      queue_(make_queue(machine, kernels, layout, config)),
      tree_context_(make_tree_context(machine, layout, config)),
      tree_(config.uses_tree() ? make_tree(context(loads_, saves_), *tree_context_) : nullptr),
      ray_stage_(context(loads_, saves_)),
      intersection_stage_(context(loads_, saves_)),
      path_stage_(context(loads_, saves_), work),
      radiance_stage_(context(radiance_loads_, radiance_saves_)) {}

void PathTracer::run(const Progress& progress) {
  fill_bins();
  while (true) {
    issue_loads();
    if (radiance_is_left() && (loading_.empty() || !is_ray_step(loading_.front()))) run_radiance_to_end();
    if (loading_.empty()) break;
    if (progress && !progress(path_stage_.camera_rays().issued())) return;
    if (is_ray_step(loading_.front())) {
      run_ray_step_with_radiance();
    } else {
      run_bin_step();
    }
  }
  announce_results();
  saves_.wait_until(next_step_);
  counts_.paths = path_stage_.camera_rays().issued();
  counts_.steps = next_step_ + next_radiance_step_;
}

void PathTracer::fill_bins() {
  for (int block = 0; block < config_.bin_blocks && path_stage_.camera_rays().remaining() > 0; ++block) {
    const std::uint64_t step = next_step_++;
    saves_.wait(step);
    machine_.set_label({path_stage_.bin(), block});
    path_stage_.fill(step, block);
    path_stage_.save(step, block);
    report_fill(block);
    live_blocks_.push_back(block);
    if (!tree_) plan(ray_stage_, block);
  }
  plan_pass();
}

/// The rest of a pass, once it is known which blocks are alive; the ray bin's steps are planned before. With
/// a tree, how many steps that bin takes shows while they run.
void PathTracer::plan_pass() {
  count_rays();
  path_steps_left_ = static_cast<int>(live_blocks_.size());
  counts_.blocks += live_blocks_.size();
  if (!live_blocks_.empty()) counts_.skipped_blocks += std::size_t(config_.bin_blocks) - live_blocks_.size();
  pass_blocks_.swap(live_blocks_);
  live_blocks_.clear();
  if (!tree_) {
    plan_after_rays();
  } else if (!pass_blocks_.empty()) {
    tree_->begin_pass(tree_plan());
  }
}

TreeTraversal::Plan PathTracer::tree_plan() {
  return [this](Stage& stage, int block) {
    plan(stage, block);
    ++tree_steps_left_;
  };
}

void PathTracer::after_tree_step(const Step& step) {
  tree_->after_step(*step.stage, step.block, tree_plan());
  if (--tree_steps_left_ > 0) return;
  queue_->clear();
  for (const int block : pass_blocks_) plan(tree_->recall(), block);
  plan_after_rays();
}

void PathTracer::plan_after_rays() {
  for (const int block : pass_blocks_) plan(intersection_stage_, block);
  for (const int block : pass_blocks_) plan(path_stage_, block);
}

void PathTracer::count_rays() {
  std::uint64_t rays = 0;
  for (const int index : live_blocks_) {
    const Bins::Block& block = bins_.blocks[std::size_t(index)];
    rays += std::uint64_t(block.live.count());
    counts_.segments += std::uint64_t(block.segments().count());
    counts_.shadow_rays += std::uint64_t(block.shadow.count());
  }
  if (rays > 0) counts_.rays.add(rays);
}

/// A step's records come from earlier steps on the same block of the bins. Few live blocks bring the two so
/// close that the earlier one has not run yet.
bool PathTracer::can_load(const Step& step) const {
  return std::none_of(loading_.begin(), loading_.end(), [&](const Step& earlier) {
    if (earlier.block != step.block) return false;
    return step.stage->works_on_slots() ? earlier.stage->works_on_slots() : earlier.stage == step.stage;
  });
}

/// How many steps may be loaded at a time, the one to be processed included. What is prepared is loaded so
/// much earlier that its second loads, too, begin n steps ahead.
std::size_t PathTracer::look_ahead(const Step& step) const {
  const int buffers = config_.load_buffers();
  return static_cast<std::size_t>(step.stage->prepares() ? 2 * buffers - 1 : buffers);
}

void PathTracer::issue_loads() {
  for (Step& step : loading_) step.just_loaded = false;
  while (!bin_steps_.empty() && loading_.size() < look_ahead(bin_steps_.front()) &&
         can_load(bin_steps_.front())) {
    Step step = bin_steps_.front();
    bin_steps_.pop_front();
    step.number = next_step_++;
    label(step);
    step.stage->load(step.number, step.block);
    loading_.push_back(step);
  }
  prepare_steps();
}

/// A step whose loads have just begun can wait for its turn, so that others need not wait for them.
void PathTracer::prepare_steps() {
  const std::size_t steps = std::min(loading_.size(), std::size_t(config_.load_buffers()));
  for (std::size_t i = 0; i < steps; ++i) {
    Step& step = loading_[i];
    if (step.is_prepared || !step.stage->prepares() || (i > 0 && step.just_loaded)) continue;
    label(step);
    step.stage->prepare(step.number, step.block);
    step.is_prepared = true;
  }
}

void PathTracer::label(const Step& step) {
  machine_.set_label({step.stage->bin(), step.block});
}

void PathTracer::report_fill(int block) {
  machine_.report_fill(block, bins_.blocks[std::size_t(block)].live);
}

void PathTracer::run_bin_step() {
  const Step step = loading_.front();
  loading_.pop_front();
  loads_.wait(step.number);
  saves_.wait(step.number);
  label(step);
  step.stage->process(step.number, step.block);
  step.stage->save(step.number, step.block);
  if (step.stage == &path_stage_) after_path_step(step);
  if (tree_ && is_ray_step(step)) after_tree_step(step);
}

void PathTracer::after_path_step(const Step& step) {
  if (radiance_is_timed()) announce_results();
  last_path_step_ = step.number;
  report_fill(step.block);
  if (bins_.blocks[std::size_t(step.block)].live.any()) {
    live_blocks_.push_back(step.block);
    if (!tree_) plan(ray_stage_, step.block);
  }
  if (--path_steps_left_ > 0) return;
  plan_radiance_of_pass();
  if (!radiance_is_timed()) run_untimed_radiance();
  path_stage_.clear_finished();
  plan_pass();
}

void PathTracer::plan_radiance_of_pass() {
  results_records_ = path_stage_.finished_count();
  radiance_stage_.fold().set_results(layout_.results[results_half_]);
  list_steps_left_ = (results_records_ + machine_.num_pes() - 1) / machine_.num_pes();
  next_list_block_ = 0;
  for (int i = 0; i < RadianceStage::kBlocksUnderWay; ++i) plan_list_step();
  ray_steps_before_radiance_ = 1;  // hides the saves of the last path step
}

/// Of the next block of the list, if there is one.
void PathTracer::plan_list_step() {
  const int first = next_list_block_ * machine_.num_pes();
  if (first >= results_records_) return;
  radiance_stage_.begin_block(next_list_block_, std::min(machine_.num_pes(), results_records_ - first));
  plan_radiance(radiance_stage_.list(), next_list_block_);
  ++next_list_block_;
}

/// The loads of radiance steps take place under the ray step, the steps themselves follow it.
void PathTracer::run_ray_step_with_radiance() {
  if (config_.buffers_loads() && ray_steps_before_radiance_ == 0) issue_radiance_loads();
  if (ray_steps_before_radiance_ > 0) --ray_steps_before_radiance_;
  run_bin_step();
  while (!radiance_loading_.empty()) run_radiance_step();
}

void PathTracer::issue_radiance_loads() {
  if (radiance_is_timed() && !radiance_steps_.empty()) saves_.wait_until(last_path_step_);
  while (radiance_loading_.size() < std::size_t(radiance_buffers(config_)) && !radiance_steps_.empty()) {
    Step step = radiance_steps_.front();
    radiance_steps_.pop_front();
    step.number = next_radiance_step_++;
    label(step);
    step.stage->load(step.number, step.block);
    radiance_loading_.push_back(step);
  }
}

void PathTracer::run_radiance_step() {
  const Step step = radiance_loading_.front();
  radiance_loading_.pop_front();
  radiance_loads_.wait(step.number);
  radiance_saves_.wait(step.number);
  label(step);
  step.stage->process(step.number, step.block);
  step.stage->save(step.number, step.block);
  if (step.stage == &radiance_stage_.list()) {
    after_list_step(step.block);
  } else {
    last_result_step_ = step.number;
    if (radiance_stage_.fold().is_last(step.block)) plan_list_step();
  }
}

void PathTracer::after_list_step(int block) {
  for (int load = radiance_stage_.loads(block) - 1; load >= 0; --load)
    plan_radiance(radiance_stage_.fold(), radiance_stage_.fold_block(block, load));
  --list_steps_left_;
}

/// Before the pass goes on: its path steps overwrite the vertices.
void PathTracer::run_radiance_to_end() {
  while (radiance_is_left()) {
    issue_radiance_loads();
    run_radiance_step();
  }
}

/// Programs that leave out radiance are timed without it, as in the paper; the image is made all the same.
void PathTracer::run_untimed_radiance() {
  const cn::Untimed untimed(machine_);
  run_radiance_to_end();
  announce_results();
}

/// Tells the host which half of the results it may read, and makes sure that the other half is free.
void PathTracer::announce_results() {
  if (results_records_ == 0) return;
  radiance_saves_.wait_until(last_result_step_);
  machine_.write_mono(layout_.results_header[results_half_], ResultsHeader{results_records_, 0});
  machine_.sem_signal(HostSemaphores::kResultsReady);
  results_records_ = 0;
  results_half_ = 1 - results_half_;
  if (++announcements_ > 1) machine_.sem_wait(HostSemaphores::kResultsFree);
}

}  // namespace path_tracer
