#pragma once

#include <vector>

#include "firmware/path_tracer/pipeline/step_pipeline.hpp"
#include "firmware/path_tracer/stages/ray_stage.hpp"
#include "firmware/path_tracer/stages/ray_store.hpp"

namespace path_tracer {

/// The search for what the rays of a pass hit, chosen at construction: the steps between the stages that make
/// rays and the intersection stage.
class RaySearch {
 public:
  RaySearch() = default;
  virtual ~RaySearch() = default;
  RaySearch(const RaySearch&) = delete;
  RaySearch& operator=(const RaySearch&) = delete;

  /// The store for the rays that stages make.
  virtual RayStore& rays() = 0;
  /// Whether a step of that stage searches for rays.
  virtual bool has(const Stage& stage) const = 0;

  /// The rays of a block of slots for the next pass are being saved.
  virtual void add_block(StepPipeline& steps, int block) = 0;
  /// The next pass begins; `blocks` hold its rays.
  /// @return whether all steps of the search are planned, so that the intersection stage can follow
  virtual bool begin_pass(StepPipeline& steps, const std::vector<int>& blocks) = 0;
  /// A step of the search was processed.
  /// @return whether this step completed the planning of the search
  virtual bool after_step(StepPipeline& steps, const Step& step, const std::vector<int>& blocks) = 0;
};

/// Brute force: one ray step for each block tests every triangle.
class BruteForceSearch : public RaySearch {
 public:
  explicit BruteForceSearch(const StageContext& context)
      : ray_bin_(context.machine, context.layout), ray_stage_(context) {}

  RayStore& rays() override { return ray_bin_; }
  bool has(const Stage& stage) const override { return &stage == &ray_stage_; }
  void add_block(StepPipeline& steps, int block) override { steps.plan(ray_stage_, block); }
  bool begin_pass(StepPipeline& /*steps*/, const std::vector<int>& /*blocks*/) override { return true; }
  bool after_step(StepPipeline& /*steps*/, const Step& /*step*/,
                  const std::vector<int>& /*blocks*/) override {
    return false;
  }

 private:
  RayBin ray_bin_;
  RayStage ray_stage_;
};

}  // namespace path_tracer
