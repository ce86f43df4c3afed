#include "firmware/path_tracer/pipeline/stream_paths.hpp"

namespace path_tracer {

void StreamPaths::begin_pass(StepPipeline& steps, const std::vector<int>& blocks) {
  steps_left_ = static_cast<int>(blocks.size());
  paths_.number_blocks(blocks);
  scan_.begin(steps_left_);
  for (const int block : blocks) steps.plan(paths_.append_stage(), block);
}

void StreamPaths::after_step(StepPipeline& steps, const Step& step, const std::vector<int>& blocks) {
  if (!has(step.stage) || --steps_left_ > 0) return;
  if (step.stage == &paths_) return paths_.end_pass();
  saves_.wait_until(step.number);
  if (step.stage == &paths_.append_stage()) return begin_sweep(steps, 0);
  if (sweep_ + 1 < scan_.sweeps()) return begin_sweep(steps, sweep_ + 1);
  end_scan(steps, blocks);
}

void StreamPaths::begin_sweep(StepPipeline& steps, int sweep) {
  sweep_ = sweep;
  steps_left_ = scan_.begin_sweep(sweep);
  for (int block = 0; block < steps_left_; ++block) steps.plan(scan_, block);
}

void StreamPaths::end_scan(StepPipeline& steps, const std::vector<int>& blocks) {
  paths_.take_numbers(scan_.total());
  steps_left_ = static_cast<int>(blocks.size());
  for (const int block : blocks) steps.plan(paths_, block);
}

}  // namespace path_tracer
