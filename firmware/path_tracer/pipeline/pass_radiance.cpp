#include "firmware/path_tracer/pipeline/pass_radiance.hpp"

#include <algorithm>

namespace path_tracer {

/// A block of finished paths takes about three steps, and two blocks of rays bring one, so that two steps
/// between ray steps are enough.
int PassRadiance::load_buffers(const ProgramConfig& config) {
  return config.program == Program::full && config.buffers_loads() ? 2 : 1;
}

PassRadiance::PassRadiance(const StageContext& context, TransferRing& path_saves)
    : context_(context),
      path_saves_(path_saves),
      stage_(context.config.is_stream() ? nullptr : std::make_unique<RadianceStage>(context)),
      stream_stage_(context.config.is_stream()
                        ? std::make_unique<StreamRadianceStage>(context, load_buffers(context.config))
                        : nullptr),
      steps_(context.machine, {context.loads, context.saves, load_buffers(context.config)}),
      results_(context.machine, context.layout) {}

void PassRadiance::begin(int finished_paths, std::uint64_t last_path_step) {
  last_path_step_ = last_path_step;
  records_ = finished_paths;
  if (stream_stage_) {
    stream_stage_->set_results(results_.half());
    stream_stage_->begin(records_);
  } else {
    stage_->fold().set_results(results_.half());
  }
  const int num_pes = context_.machine.num_pes();
  list_steps_left_ = (records_ + num_pes - 1) / num_pes;
  next_list_block_ = 0;
  for (int i = 0; i < RadianceStage::kBlocksUnderWay; ++i) plan_list_step();
  ray_steps_before_ = 1;  // hides the saves of the last path step
  if (is_timed()) return;
  const cn::Untimed untimed(context_.machine);
  run_to_end();
  announce_results();
}

/// Plans the list step of the next block of finished paths, if there is one.
void PassRadiance::plan_list_step() {
  const int num_pes = context_.machine.num_pes();
  const int first = next_list_block_ * num_pes;
  if (first >= records_) return;
  if (stream_stage_) {
    steps_.plan(*stream_stage_, next_list_block_);
  } else {
    stage_->begin_block(next_list_block_, std::min(num_pes, records_ - first));
    steps_.plan(stage_->list(), next_list_block_);
  }
  ++next_list_block_;
}

void PassRadiance::before_ray_step() {
  if (context_.config.buffers_loads() && ray_steps_before_ == 0) load_ahead();
  if (ray_steps_before_ > 0) --ray_steps_before_;
}

void PassRadiance::after_ray_step() {
  while (steps_.next() != nullptr) run_step();
}

void PassRadiance::load_ahead() {
  if (is_timed() && steps_.has_planned()) path_saves_.wait_until(last_path_step_);
  steps_.load_ahead();
}

void PassRadiance::run_step() {
  const Step step = steps_.run_next();
  if (stage_ && step.stage == &stage_->list()) return after_list_step(step.block);
  last_result_step_ = step.number;
  if (stream_stage_) --list_steps_left_;
  if (stream_stage_ || stage_->fold().is_last(step.block)) plan_list_step();
}

void PassRadiance::after_list_step(int block) {
  for (int load = stage_->loads(block) - 1; load >= 0; --load)
    steps_.plan(stage_->fold(), stage_->fold_block(block, load));
  --list_steps_left_;
}

void PassRadiance::run_to_end() {
  while (is_left()) {
    load_ahead();
    run_step();
  }
}

void PassRadiance::announce_results() {
  if (records_ == 0) return;
  context_.saves.wait_until(last_result_step_);
  results_.announce(records_);
  records_ = 0;
}

}  // namespace path_tracer
