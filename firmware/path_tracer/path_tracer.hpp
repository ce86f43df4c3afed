#pragma once

#include <deque>
#include <functional>
#include <memory>

#include "firmware/path_tracer/stages.hpp"

namespace path_tracer {

/// Semaphores that the firmware shares with the host. Both sides know them by number, as the host's driver
/// does.
struct HostSemaphores {
  static constexpr cn::Semaphore kResultsReady{
      0};  ///< signalled by the firmware, one half of the results is full
  static constexpr cn::Semaphore kResultsFree{1};  ///< signalled by the host, it has read that half
};

/// The firmware's main program: binned, n-buffered path tracing (paper, section 3).
///
/// A step is one stage on one block. Steps run one after the other: all blocks through the ray bin, then the
/// intersection bin, the shadow rays and the path bin, and again until no camera ray and no path is left. The
/// radiance of the paths that finished is computed between the ray steps of the next pass: its transfers are
/// long and its kernels short, the ray bin's are the other way round. While step m is processed, the loads of
/// steps m+1..m+n and the saves of steps m-1..m-n are under way, across the borders between bins.
class PathTracer {
 public:
  /// `machine` has the scene image of `layout` in mono memory. Throws ProgramError, cn::PolyMemoryOverflow.
  PathTracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config, const Layout& layout,
             const Work& work);

  /// Called between steps with the camera paths issued so far; returns false to stop early.
  using Progress = std::function<bool(std::uint64_t paths_issued)>;

  void run(const Progress& progress);

  const RunCounts& counts() const { return counts_; }

 private:
  struct Step {
    Stage* stage;
    int block;
    std::uint64_t number;  ///< in the order of loading, which is that of processing
  };
  using Steps = std::deque<Step>;

  void plan(Stage& stage, int block) { bin_steps_.push_back({&stage, block, 0}); }
  void plan_radiance(Stage& stage, int block) { radiance_steps_.push_back({&stage, block, 0}); }
  Steps* next_steps();
  bool can_load(const Step& step) const;
  bool is_radiance(const Step& step) const {
    return step.stage == &radiance_stage_.list() || step.stage == &radiance_stage_.fold();
  }
  void fill_bins();
  void issue_loads();
  void run_step();
  void after_path_step(int block);
  void after_list_step(int block);
  void plan_pass();
  void plan_radiance_of_pass();
  void announce_results();
  void run_untimed_radiance();
  StageContext context() { return {machine_, kernels_, config_, layout_, loads_, saves_, bins_, counts_}; }
  bool radiance_is_timed() const { return config_.program == Program::full; }

  cn::Machine& machine_;
  const Kernels& kernels_;
  ProgramConfig config_;
  Layout layout_;
  RunCounts counts_;
  Bins bins_;
  TransferRing loads_;
  TransferRing saves_;
  std::unique_ptr<TransferRing> untimed_loads_;
  std::unique_ptr<TransferRing> untimed_saves_;
  RayStage ray_stage_;
  IntersectionStage intersection_stage_;
  LightStage light_stage_;
  RayStage shadow_ray_stage_;
  LightingStage lighting_stage_;
  PathStage path_stage_;
  RadianceStage radiance_stage_;

  Steps bin_steps_;       ///< planned, in order
  Steps radiance_steps_;  ///< planned, to be put between ray steps
  Steps loading_;         ///< their loads are under way or done; the front is processed next
  std::uint64_t next_step_ = 0;
  int rays_before_radiance_ = 0;  ///< ray steps still to be loaded before the next radiance step

  std::vector<int> live_blocks_;  ///< of the pass that is being planned
  int path_steps_left_ = 0;       ///< of the pass that runs
  int list_steps_left_ = 0;       ///< of the pass before; each will plan fold steps

  int results_half_ = 0;
  int results_records_ = 0;  ///< finished but not yet announced
  std::uint64_t last_result_step_ = 0;
  int announcements_ = 0;
};

}  // namespace path_tracer
