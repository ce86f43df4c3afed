#pragma once

#include "firmware/path_tracer/traversals/record_stage.hpp"
#include "firmware/path_tracer/traversals/traversal_bin.hpp"
#include "firmware/path_tracer/traversals/tree_search.hpp"

/// The circular buffer within the intersection step that the paper's section 5 sketches. Rays wait in a
/// temporary bin, each with the leaf that it is to be tested against and the piece of the tree that it needs
/// to find the next leaf.
namespace path_tracer {

/// The rays in SRAM and the bin that they pass through.
struct TemporaryBinContext {
  TemporaryBinContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout);

  RecordRing records;
  TraversalBin bin;
  PolyField<std::int32_t> number;
};

/// Puts the remaining rays back into the bin.
class TemporaryBinStage : public RecordStage {
 public:
  TemporaryBinStage(const StageContext& context, TreeContext& tree, TemporaryBinContext& rays)
      : RecordStage(context, tree, rays.records), rays_(rays) {}

 protected:
  void put_back(std::uint64_t step, const LaneMask& rays, const LaneMask& alive, std::size_t pass) override;

  TemporaryBinContext& rays_;
};

/// Traverse stage: loads rays, then what they need; tests leaves and continues through the tree. Its blocks
/// are those of the bin's ring.
class TraverseStage : public TemporaryBinStage {
 public:
  TraverseStage(const StageContext& context, TreeContext& tree, TemporaryBinContext& rays);

  const char* name() const override { return "traverse stage"; }
  bool prepares() const override { return true; }
  void load(std::uint64_t step, int block) override;
  void prepare(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;

 private:
  /// State of a step, from its load to its end.
  struct State {
    LaneMask rays;
    Needs needs;
  };
  State& state(std::uint64_t step) { return states_[step % states_.size()]; }

  std::vector<State> states_;
};

class TemporaryBinTraversal : public TreeTraversal {
 public:
  TemporaryBinTraversal(const StageContext& context, TreeContext& tree);

  void plan_first(const Plan& plan) override;
  void after_step(const Stage& stage, int block, const Plan& plan) override;
  bool has(const Stage& stage) const override { return &stage == &begin_ || &stage == &traverse_; }

 private:
  void plan_block(const Plan& plan, int block);

  RayQueue& queue_;
  int num_pes_;
  TemporaryBinContext rays_;
  BeginStage<TemporaryBinStage> begin_;
  TraverseStage traverse_;
  int steps_left_ = 0;  ///< planned and not yet processed
};

}  // namespace path_tracer
