#pragma once

#include "firmware/path_tracer/traversal_bin.hpp"
#include "firmware/path_tracer/tree_stage.hpp"

/// The circular buffer within the intersection step that the paper's section 5 sketches: rays wait in a
/// temporary bin, each with the leaf that it is to be tested against and the piece of the tree that it needs to
/// find the next one.
namespace path_tracer {

/// The rays in SRAM and the bin that they go round.
struct TemporaryBinContext {
  TemporaryBinContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout);

  TransferRing records;  ///< a buffer stays a step's from its load to the end of its save
  TraversalBin bin;
  PolyField<std::int32_t> number;

  static int record_buffers(const ProgramConfig& config);
};

/// What both stages do at their ends: rays that go on are saved to the bin.
class TemporaryBinStage : public TreeStage {
 public:
  TemporaryBinStage(const StageContext& context, TreeContext& tree, TemporaryBinContext& rays)
      : TreeStage(context, tree), rays_(rays) {}
  void save(std::uint64_t step, int block) override;

 protected:
  PolyPointer<TraversalRecord> record(std::uint64_t step) const {
    return PolyPointer<TraversalRecord>(rays_.records.buffer(step));
  }
  PolyField<MonoAddress> record_to(std::uint64_t step) const;
  void traverse_and_sort(std::uint64_t step, const LaneMask& rays, const Needs& needs, std::size_t pass);

  TemporaryBinContext& rays_;

 private:
  LaneMask alive_;
};

/// Ray bin: takes rays as far as the resident nodes go, into the traversal bin. Its blocks are the ray bin's,
/// packed.
class BeginStage : public TemporaryBinStage {
 public:
  using TemporaryBinStage::TemporaryBinStage;

  const char* bin() const override { return "ray bin"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
};

/// Traversal bin: loads rays, then what they need, tests leaves, goes on through the tree. Its blocks are the
/// ring's.
class TraverseStage : public TemporaryBinStage {
 public:
  TraverseStage(const StageContext& context, TreeContext& tree, TemporaryBinContext& rays);

  const char* bin() const override { return "traversal bin"; }
  bool prepares() const override { return true; }
  void load(std::uint64_t step, int block) override;
  void prepare(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;

 private:
  /// Of a step, from its load to its end.
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

  void after_step(const Stage& stage, int block, const Plan& plan) override;
  bool has(const Stage& stage) const override { return &stage == &begin_ || &stage == &traverse_; }

 protected:
  void plan_first(const Plan& plan) override;

 private:
  void plan_block(const Plan& plan, int block);

  RayQueue& queue_;
  int num_pes_;
  TemporaryBinContext rays_;
  BeginStage begin_;
  TraverseStage traverse_;
  int steps_left_ = 0;  ///< that are planned
};

}  // namespace path_tracer
