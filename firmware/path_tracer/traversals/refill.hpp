#pragma once

#include "firmware/path_tracer/traversals/tree_search.hpp"
#include "firmware/path_tracer/traversals/tree_stage.hpp"

/// A circular buffer for the intersection step that differs from the paper's: rays stay in the SRAM of their
/// PE until they are finished, and "the PEs with unsuccessful task can load more data" (paper, section 4).
/// For n-buffering, n + 1 groups of one ray a PE take turns: while one group is processed, the loads of the
/// others are under way.
namespace path_tracer {

/// A turn of a group: loads what its rays need of the tree, and new rays for idle PEs; then takes all rays as
/// far as they can go. Its blocks are the groups.
class RefillStage : public TreeStage {
 public:
  RefillStage(const StageContext& context, TreeContext& tree);

  const char* name() const override { return "refill stage"; }
  void load(std::uint64_t step, int index) override;
  void process(std::uint64_t step, int index) override;
  void save(std::uint64_t step, int /*group*/) override { save_hits(step); }

  int groups() const { return static_cast<int>(groups_.size()); }
  bool has_rays(int group) const { return groups_[std::size_t(group)].going_on > 0; }

 private:
  struct Group {
    PolyPointer<TraversalRecord> record;
    LaneMask alive;    ///< PEs with a remaining ray
    int going_on = 0;  ///< number of PEs in `alive`
    LaneMask fresh;    ///< PEs whose ray is being loaded
    Needs needs;
    std::vector<std::size_t> passes;  ///< turns that each PE's ray has had; for counts only
  };
  void load_rays(std::uint64_t step, Group& group);
  void count_turns(Group& group, const LaneMask& rays);

  std::vector<Group> groups_;
  PolyField<std::int32_t> number_;
  int least_idle_;  ///< number of idle PEs from which on new rays are loaded
};

class RefillTraversal : public TreeTraversal {
 public:
  RefillTraversal(const StageContext& context, TreeContext& tree)
      : queue_(tree.queue), stage_(context, tree) {}

  void plan_first(const Plan& plan) override;
  void after_step(const Stage& stage, int group, const Plan& plan) override;
  bool has(const Stage& stage) const override { return &stage == &stage_; }

 private:
  RayQueue& queue_;
  RefillStage stage_;
};

}  // namespace path_tracer
