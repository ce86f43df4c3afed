#pragma once

#include <vector>

#include "firmware/path_tracer/pipeline/step_pipeline.hpp"
#include "firmware/path_tracer/stages/hit_bins.hpp"

namespace path_tracer {

/// The steps between the ray search and the path stage where hits wait in bins of their kind: all hits of a
/// pass go into their bins, then bin after bin is shaded, then the slots learn which of them cast a shadow
/// ray. How many groups of hits there are shows when all are in their bins.
class HitBinning {
 public:
  HitBinning(const StageContext& context, RayStore& rays)
      : num_pes_(context.machine.num_pes()),
        kinds_(hit_kinds(context.config.features)),
        recalls_casts_(context.config.casts_shadow_rays()),
        bin_hits_(context, bins_),
        intersection_(context, rays, bins_),
        recall_casts_(context, bins_) {}

  /// The search of a pass is planned; `blocks` hold its rays.
  void begin_pass(StepPipeline& steps, const std::vector<int>& blocks);
  /// A step was processed.
  /// @return whether the path stage can follow the steps that are planned
  bool after_step(StepPipeline& steps, const Step& step, const std::vector<int>& blocks);

 private:
  const int num_pes_;
  const int kinds_;
  const bool recalls_casts_;
  HitBins bins_;
  BinHitsStage bin_hits_;
  BinnedIntersectionStage intersection_;
  RecallCastsStage recall_casts_;
  int steps_left_ = 0;  ///< of the stage whose steps are running
};

}  // namespace path_tracer
