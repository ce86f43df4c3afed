#pragma once

#include <vector>

#include "firmware/path_tracer/pipeline/step_pipeline.hpp"
#include "firmware/path_tracer/stages/scan_stage.hpp"
#include "firmware/path_tracer/stages/stream_path_stage.hpp"

namespace path_tracer {

/// The path steps of a pass in stream execution: the first half of the path stage on every block, the scan
/// sweep by sweep, the second half on every block. Each of these needs all of the one before it.
class StreamPaths {
 public:
  StreamPaths(const StageContext& context, StreamPathStage& paths)
      : saves_(context.saves), paths_(paths), scan_(context) {}

  void begin_pass(StepPipeline& steps, const std::vector<int>& blocks);
  /// A step was processed. Plans what follows from it.
  void after_step(StepPipeline& steps, const Step& step, const std::vector<int>& blocks);

 private:
  void begin_sweep(StepPipeline& steps, int sweep);
  void end_scan(StepPipeline& steps, const std::vector<int>& blocks);
  bool has(const Stage* stage) const {
    return stage == &paths_.append_stage() || stage == &scan_ || stage == &paths_;
  }

  TransferRing& saves_;
  StreamPathStage& paths_;
  ScanStage scan_;
  int sweep_ = 0;
  int steps_left_ = 0;  ///< of the stage whose steps are running
};

}  // namespace path_tracer
