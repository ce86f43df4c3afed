#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>

#include "firmware/path_tracer/stages/stages.hpp"
#include "firmware/path_tracer/traversals/tree_stage.hpp"

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
/// intersection bin and the path bin, and again until no camera ray and no path is left. While step m is
/// processed, the loads of steps m+1..m+n and the saves of steps m-1..m-n are under way, across the borders
/// between bins.
///
/// The radiance of the paths that finished is computed between the ray steps of the next pass, in buffers of
/// its own: its transfers are long and its kernels short, the ray bin's are the other way round.
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
    std::uint64_t number = 0;  ///< in the order of loading, which is that of processing
    bool just_loaded = true;   ///< its loads were begun after the last step was processed
    bool is_prepared = false;  ///< Stage::prepare()
  };
  using Steps = std::deque<Step>;

  void plan(Stage& stage, int block) { bin_steps_.push_back({&stage, block}); }
  void plan_radiance(Stage& stage, int block) { radiance_steps_.push_back({&stage, block}); }
  bool is_ray_step(const Step& step) const {
    return step.stage == &ray_stage_ || (tree_ && tree_->has(*step.stage));
  }
  std::size_t look_ahead(const Step& step) const;
  bool can_load(const Step& step) const;
  void label(const Step& step);
  void report_fill(int block);
  bool radiance_is_timed() const { return config_.program == Program::full; }
  bool radiance_is_left() const {
    return !radiance_steps_.empty() || !radiance_loading_.empty() || list_steps_left_ > 0;
  }

  void fill_bins();
  void issue_loads();
  void prepare_steps();
  void run_bin_step();
  void run_ray_step_with_radiance();
  void after_path_step(const Step& step);
  void plan_pass();
  TreeTraversal::Plan tree_plan();
  void plan_after_rays();
  void after_tree_step(const Step& step);
  void count_rays();
  void plan_radiance_of_pass();
  void plan_list_step();
  void issue_radiance_loads();
  void run_radiance_step();
  void run_radiance_to_end();
  void run_untimed_radiance();
  void after_list_step(int block);
  void announce_results();
  StageContext context(TransferRing& loads, TransferRing& saves) {
    return {machine_, kernels_, config_, layout_, loads, saves, bins_, counts_, queue_ ? &*queue_ : nullptr};
  }

  cn::Machine& machine_;
  const Kernels& kernels_;
  ProgramConfig config_;
  Layout layout_;
  RunCounts counts_;
  Bins bins_;
  TransferRing loads_;
  TransferRing saves_;
  TransferRing radiance_loads_;
  TransferRing radiance_saves_;
  std::optional<RayQueue> queue_;  ///< these three with a tree only
  std::optional<TreeContext> tree_context_;
  std::unique_ptr<TreeTraversal> tree_;
  RayStage ray_stage_;
  IntersectionStage intersection_stage_;
  PathStage path_stage_;
  RadianceStage radiance_stage_;

  Steps bin_steps_;  ///< planned, in order
  Steps loading_;    ///< their loads are under way or done; the front is processed next
  std::uint64_t next_step_ = 0;
  std::vector<int> live_blocks_;      ///< of the pass that is being planned
  std::vector<int> pass_blocks_;      ///< of the pass that runs
  int tree_steps_left_ = 0;           ///< that are planned
  int path_steps_left_ = 0;           ///< of the pass that runs
  std::uint64_t last_path_step_ = 0;  ///< which saves the list of finished paths

  Steps radiance_steps_;
  Steps radiance_loading_;
  std::uint64_t next_radiance_step_ = 0;
  int list_steps_left_ = 0;  ///< each will plan fold steps
  int next_list_block_ = 0;  ///< the first that has not been planned
  int ray_steps_before_radiance_ = 0;

  int results_half_ = 0;
  int results_records_ = 0;  ///< finished but not yet announced
  std::uint64_t last_result_step_ = 0;
  int announcements_ = 0;
};

}  // namespace path_tracer
