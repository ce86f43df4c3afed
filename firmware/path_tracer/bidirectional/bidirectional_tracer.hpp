#pragma once

#include <memory>
#include <vector>

#include "firmware/path_tracer/bidirectional/connection_stage.hpp"
#include "firmware/path_tracer/bidirectional/vertex_stage.hpp"
#include "firmware/path_tracer/pipeline/pass.hpp"
#include "firmware/path_tracer/pipeline/results_handover.hpp"
#include "firmware/path_tracer/pipeline/scratchpad_records.hpp"
#include "firmware/path_tracer/pipeline/step_pipeline.hpp"
#include "firmware/path_tracer/traversals/search_choice.hpp"

namespace path_tracer {

/// The firmware's main program for bidirectional paths (paper, section 5: "The required visibility test could
/// be handled within the circular buffer framework"). A pass takes all slots through the ray search, the
/// vertex stage and the connection stage. Their steps run in one pipeline, as those of PathTracer.
class BidirectionalTracer : public Tracer {
 public:
  /// As PathTracer's.
  BidirectionalTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                      const Layout& layout, const Work& work);

  void run(const Progress& progress) override;

  const RunCounts& counts() const override { return counts_; }

 private:
  void fill_bins();
  void run_next_step();
  void plan_connections(int block);
  void after_connection_step(int block);
  void begin_pass();
  void plan_vertex_stage();
  void announce_results();
  StageContext context() {
    return {machine_, kernels_, config_, layout_, rings_.loads, rings_.saves, bins_, counts_};
  }

  cn::Machine& machine_;
  const Kernels& kernels_;
  ProgramConfig config_;
  Layout layout_;
  RunCounts counts_;
  Bins bins_;
  Rings rings_;
  ScratchpadRecords scratchpad_;  ///< before the search, which loads resident nodes
  std::unique_ptr<RaySearch> search_;
  PairContext pairs_;
  VertexStage vertex_stage_;
  ConnectionStage connection_stage_;
  StepPipeline steps_;
  ResultsHandover results_;
  std::vector<int> blocks_;       ///< of the pass
  std::vector<int> next_blocks_;  ///< with rays for the next one
  std::size_t vertex_steps_left_ = 0;
  std::size_t connection_steps_left_ = 0;
};

}  // namespace path_tracer
