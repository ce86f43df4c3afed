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
  return static_cast<std::size_t>(loads_early(step) ? 2 * buffers_.steps - 1 : buffers_.steps);
}

void StepPipeline::load_ahead() {
  for (Step& step : loaded_) step.just_loaded = false;
  while (!planned_.empty() && loaded_.size() < look_ahead(planned_.front()) && can_load(planned_.front())) {
    Step step = planned_.front();
    planned_.pop_front();
    step.number = next_number_++;
    label(*step.stage, step.block);
    load(step);
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
    if (step.is_prepared || !prepares(step) || (i > 0 && step.just_loaded)) continue;
    label(*step.stage, step.block);
    prepare(step);
    step.is_prepared = true;
  }
}

void StepPipeline::load(const Step& step) {
  if (loads_slot_states(step)) {
    buffers_.slot_states->load(step.number, step.block);
  } else {
    step.stage->load(step.number, step.block);
  }
}

void StepPipeline::prepare(const Step& step) {
  if (loads_slot_states(step)) {
    buffers_.slot_states->recall(step.number, step.block);
    step.stage->load(step.number, step.block);
  }
  if (step.stage->prepares()) step.stage->prepare(step.number, step.block);
}

void StepPipeline::save(const Step& step) {
  step.stage->save(step.number, step.block);
  if (loads_slot_states(step)) buffers_.slot_states->save(step.number, step.block);
}

Step StepPipeline::run_next() {
  const Step step = loaded_.front();
  loaded_.pop_front();
  if (prepares(step) && !step.is_prepared) prepare(step);  // several steps run after one load_ahead()
  buffers_.loads.wait(step.number);
  buffers_.saves.wait(step.number);
  label(*step.stage, step.block);
  step.stage->process(step.number, step.block);
  save(step);
  return step;
}

void StepPipeline::wait_for_saves() {
  buffers_.saves.wait_until(next_number_);
  if (buffers_.slot_states != nullptr) buffers_.slot_states->wait_until(next_number_);
}

void StepPipeline::run_without_loads(Stage& stage, int block,
                                     const std::function<void(std::uint64_t step)>& process) {
  const std::uint64_t number = next_number_++;
  buffers_.saves.wait(number);
  label(stage, block);
  const Step step{&stage, block, number};
  if (loads_slot_states(step)) buffers_.slot_states->claim(number, block);
  process(number);
  save(step);
}

}  // namespace path_tracer
