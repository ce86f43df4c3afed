#include "firmware/path_tracer/pipeline/hit_binning.hpp"

namespace path_tracer {

void HitBinning::begin_pass(StepPipeline& steps, const std::vector<int>& blocks) {
  bins_.clear(kinds_);
  steps_left_ = static_cast<int>(blocks.size());
  for (const int block : blocks) steps.plan(bin_hits_, block);
}

bool HitBinning::after_step(StepPipeline& steps, const Step& step, const std::vector<int>& blocks) {
  const bool is_binning = step.stage == &bin_hits_;
  if ((!is_binning && step.stage != &intersection_) || --steps_left_ > 0) return false;
  if (is_binning) {
    bins_.group(num_pes_);
    steps_left_ = static_cast<int>(bins_.groups.size());
    for (int group = 0; group < steps_left_; ++group) steps.plan(intersection_, group);
    return false;
  }
  if (recalls_casts_)
    for (const int block : blocks) steps.plan(recall_casts_, block);
  return true;
}

}  // namespace path_tracer
