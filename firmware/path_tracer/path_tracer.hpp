#pragma once

#include <memory>

#include "firmware/path_tracer/pipeline/hit_binning.hpp"
#include "firmware/path_tracer/pipeline/pass.hpp"
#include "firmware/path_tracer/pipeline/pass_radiance.hpp"
#include "firmware/path_tracer/pipeline/ray_search.hpp"
#include "firmware/path_tracer/pipeline/scratchpad_records.hpp"
#include "firmware/path_tracer/pipeline/step_pipeline.hpp"
#include "firmware/path_tracer/pipeline/stream_paths.hpp"
#include "firmware/path_tracer/pipeline/tracer.hpp"
#include "firmware/path_tracer/stages/intersection_stage.hpp"
#include "firmware/path_tracer/stages/stream_path_stage.hpp"

namespace path_tracer {

/// The firmware's main program: binned, n-buffered path tracing (paper, section 3).
///
/// Blocks of slots go round the circular buffer pass by pass: ray search, intersection stage, path stage,
/// until no camera ray and no path is left. The steps of all stages run in one pipeline (step_pipeline.hpp).
/// The radiance of the paths that a pass finished is computed between the ray steps of the next one
/// (pass_radiance.hpp).
class PathTracer : public Tracer {
 public:
  /// `machine` has the scene image of `layout` in mono memory. Throws ProgramError, cn::PolyMemoryOverflow.
  PathTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config, const Layout& layout,
             const Work& work);

  void run(const Progress& progress) override;

  const RunCounts& counts() const override { return counts_; }

 private:
  bool next_is_ray_step() const { return steps_.next() != nullptr && search_->has(*steps_.next()->stage); }
  void fill_bins();
  void run_next_step();
  void after_path_step(const Step& step);
  void take_into_next_pass(int block);
  void begin_pass();
  void take_empty_blocks();
  void plan_after_search();
  void plan_path_stage();
  void report_fill(int block);
  static Rings make_radiance_rings(cn::Machine& machine, const ProgramConfig& config);
  StageContext context(Rings& rings) {
    return {machine_, kernels_, config_, layout_, rings.loads, rings.saves, bins_, counts_};
  }

  cn::Machine& machine_;
  const Kernels& kernels_;
  ProgramConfig config_;
  Layout layout_;
  RunCounts counts_;
  Bins bins_;
  Rings rings_;
  Rings radiance_rings_;
  ScratchpadRecords scratchpad_;  ///< before the search, which loads resident nodes
  std::unique_ptr<RaySearch> search_;
  IntersectionStage intersection_stage_;
  std::unique_ptr<HitBinning> hit_binning_;  ///< in its place, or null
  std::unique_ptr<PathStage> path_stage_;
  std::unique_ptr<StreamPaths> stream_paths_;  ///< steps of the path stage in stream execution, or null
  std::unique_ptr<SlotStates> slot_states_;    ///< of stream execution, or null
  StepPipeline steps_;
  PassRadiance radiance_;
  Pass pass_;
};

}  // namespace path_tracer
