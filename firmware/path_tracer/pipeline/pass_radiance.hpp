#pragma once

#include <memory>

#include "firmware/path_tracer/pipeline/results_handover.hpp"
#include "firmware/path_tracer/pipeline/step_pipeline.hpp"
#include "firmware/path_tracer/stages/radiance_stage.hpp"
#include "firmware/path_tracer/stages/stream_radiance_stage.hpp"

namespace path_tracer {

/// The radiance of the paths that a pass finished. It is computed between the ray steps of the next pass, in
/// buffers of its own: its transfers are long and its kernels short, while ray steps are the other way round.
class PassRadiance {
 public:
  /// @param context with the rings of the radiance
  /// @param path_saves ring by which the path stage saves the list of finished paths
  PassRadiance(const StageContext& context, TransferRing& path_saves);

  /// Buffers of its load ring.
  static int load_buffers(const ProgramConfig& config);
  static int load_bytes(const ProgramConfig& config) {
    return config.is_stream() ? StreamRadianceStage::load_bytes(config) : RadianceStage::kLoadBytes;
  }

  /// Plans the first steps for a pass that listed `finished_paths`, the last of them in path step
  /// `last_path_step`. A program that leaves out radiance is timed without it, as in the paper: all steps run
  /// at once, untimed.
  void begin(int finished_paths, std::uint64_t last_path_step);

  bool is_left() const { return steps_.has_planned() || steps_.next() != nullptr || list_steps_left_ > 0; }
  /// Begins loads, which take place under the ray step that follows.
  void before_ray_step();
  /// Runs the steps that were loaded.
  void after_ray_step();
  /// Runs all steps that are left. The path steps of the next pass overwrite the vertices, so it comes before
  /// them.
  void run_to_end();

  /// Announces results that are complete and not yet announced, if there are any.
  void announce_results();
  /// announce_results() between path steps, if the program is timed with radiance.
  void announce_timed_results() {
    if (is_timed()) announce_results();
  }

  /// Steps whose loads were begun.
  std::uint64_t steps() const { return steps_.steps(); }

 private:
  bool is_timed() const { return context_.config.program == Program::full; }
  void plan_list_step();
  void load_ahead();
  void run_step();
  void after_list_step(int block);

  StageContext context_;
  TransferRing& path_saves_;
  std::unique_ptr<RadianceStage> stage_;
  std::unique_ptr<StreamRadianceStage> stream_stage_;  ///< in its place, in stream execution
  StepPipeline steps_;
  ResultsHandover results_;
  std::uint64_t last_path_step_ = 0;  ///< its save completes the list of finished paths
  int records_ = 0;                   ///< results of the pass, until they are announced
  std::uint64_t last_result_step_ = 0;
  int list_steps_left_ = 0;   ///< each will plan fold steps
  int next_list_block_ = 0;   ///< the first that has not been planned
  int ray_steps_before_ = 0;  ///< to run before the first loads
};

}  // namespace path_tracer
