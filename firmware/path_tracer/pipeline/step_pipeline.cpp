#include "firmware/path_tracer/pipeline/step_pipeline.hpp"

#include <algorithm>

namespace path_tracer {

/// A step's records come from earlier steps on the same block. With few live blocks, such a step may still be
/// among the loaded ones.
bool StepPipeline::can_load(const Step& step) const {
  return std::none_of(loaded_.begin(), loaded_.end(), [&](const Step& earlier) {
    if (earlier.block != step.block) return false;
    return step.stage->works_on_slots() ? earlier.stage->works_on_slots() : earlier.stage == step.stage;
  });
}

/// A stage whose first loads have buffers of their own begins so early that the second loads, too, begin n
/// steps ahead.
std::size_t StepPipeline::look_ahead(const Step& step) const {
  return static_cast<std::size_t>(step.stage->loads_early() ? 2 * buffers_.steps - 1 : buffers_.steps);
}

void StepPipeline::load_ahead() {
  for (Step& step : loaded_) step.just_loaded = false;
  while (!planned_.empty() && loaded_.size() < look_ahead(planned_.front()) && can_load(planned_.front())) {
    Step step = planned_.front();
    planned_.pop_front();
    step.number = next_number_++;
    label(*step.stage, step.block);
    step.stage->load(step.number, step.block);
    loaded_.push_back(step);
  }
  prepare_steps();
}

/// A step whose loads have just begun is prepared later unless it is the next one, so that the steps before
/// it need not wait for these loads.
void StepPipeline::prepare_steps() {
  const std::size_t steps = std::min(loaded_.size(), std::size_t(buffers_.steps));
  for (std::size_t i = 0; i < steps; ++i) {
    Step& step = loaded_[i];
    if (step.is_prepared || !step.stage->prepares() || (i > 0 && step.just_loaded)) continue;
    label(*step.stage, step.block);
    step.stage->prepare(step.number, step.block);
    step.is_prepared = true;
  }
}

Step StepPipeline::run_next() {
  const Step step = loaded_.front();
  loaded_.pop_front();
  buffers_.loads.wait(step.number);
  buffers_.saves.wait(step.number);
  label(*step.stage, step.block);
  step.stage->process(step.number, step.block);
  step.stage->save(step.number, step.block);
  return step;
}

void StepPipeline::run_without_loads(Stage& stage, int block,
                                     const std::function<void(std::uint64_t step)>& process) {
  const std::uint64_t number = next_number_++;
  buffers_.saves.wait(number);
  label(stage, block);
  process(number);
  stage.save(number, block);
}

}  // namespace path_tracer
