#pragma once

#include "firmware/path_tracer/traversals/tree_stage.hpp"

/// Another circular buffer than the paper's for the intersection step: rays stay in the SRAM of their PE
/// until they are through, and "the PEs with unsuccessful task can load more data" (paper, section 4). What
/// n-buffering wants besides the rays that are processed are others whose loads are under way: n + 1 groups
/// of a ray a PE take turns.
namespace path_tracer {

/// A turn of a group: what its rays want of the tree is loaded, new rays are loaded for idle PEs; then all go
/// on as far as they can. Its blocks are the groups.
class RefillStage : public TreeStage {
 public:
  RefillStage(const StageContext& context, TreeContext& tree);

  const char* bin() const override { return "traversal"; }
  void load(std::uint64_t step, int index) override;
  void process(std::uint64_t step, int index) override;
  void save(std::uint64_t step, int /*group*/) override { save_hits(step); }

  int groups() const { return static_cast<int>(groups_.size()); }
  bool has_rays(int group) const { return groups_[std::size_t(group)].going_on > 0; }

 private:
  struct Group {
    PolyPointer<TraversalRecord> record;
    LaneMask alive;    ///< PEs with a ray that goes on
    int going_on = 0;  ///< how many those are
    LaneMask fresh;    ///< PEs whose ray is being loaded
    Needs needs;
    std::vector<std::size_t> passes;  ///< by PE, how many turns its ray has had; for counts only
  };
  void load_rays(std::uint64_t step, Group& group);
  void count_turns(Group& group, const LaneMask& rays);

  std::vector<Group> groups_;
  PolyField<std::int32_t> number_;
  int least_idle_;  ///< PEs, before new rays are loaded for them
};

class RefillTraversal : public TreeTraversal {
 public:
  RefillTraversal(const StageContext& context, TreeContext& tree)
      : TreeTraversal(context, tree), queue_(*context.queue), stage_(context, tree) {}

  void after_step(const Stage& stage, int group, const Plan& plan) override;
  bool has(const Stage& stage) const override { return &stage == &stage_; }

 protected:
  void plan_first(const Plan& plan) override;

 private:
  RayQueue& queue_;
  RefillStage stage_;
};

}  // namespace path_tracer
