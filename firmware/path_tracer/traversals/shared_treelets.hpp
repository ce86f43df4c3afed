#pragma once

#include "firmware/path_tracer/traversals/record_stage.hpp"
#include "firmware/path_tracer/traversals/tree_search.hpp"
#include "firmware/path_tracer/traversals/treelet_queues.hpp"

/// Rays grouped by the treelet that they need next (queues at treelets: Pharr, Kolb, Gershbein, Hanrahan,
/// "Rendering Complex Scenes with Memory-Coherent Ray Tracing", SIGGRAPH 1997; Aila, Karras, HPG 2010). All
/// rays of a block go through the same treelet.
///
/// The treelet comes into the PEs word by word, as a mono operand that a kernel stores. PIO would serve PE
/// after PE though all need the same data. Where it consolidates equal addresses
/// (pio.consolidate_equal_addresses), it would still need the set-up time of a request, which is about the
/// kernel's time for a small treelet.
///
/// The control unit learns by reductions which treelets a block's rays need next, the least of them first
/// (cn::keep_least). So the time to sort a block depends on the number of different treelets.
namespace path_tracer {

/// The rays in SRAM and the queues that they pass through.
struct SharedTreeletContext {
  SharedTreeletContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout);

  RecordRing records;
  TreeletQueues queues;
  PolyField<std::int32_t> number;
  int slot_bits;  ///< bits of a node's slot number
};

/// Puts the remaining rays back into the queues.
class SharedTreeletStage : public RecordStage {
 public:
  SharedTreeletStage(const StageContext& context, TreeContext& tree, SharedTreeletContext& rays)
      : RecordStage(context, tree, rays.records), rays_(rays) {}

 protected:
  void put_back(std::uint64_t step, const LaneMask& rays, const LaneMask& alive, std::size_t pass) override;

  SharedTreeletContext& rays_;

 private:
  void sort(std::uint64_t step, const LaneMask& alive, int rays);
  std::int32_t least_treelet(std::uint64_t step, const LaneMask& rays);
  LaneMask rays_of_treelet(std::uint64_t step, std::int32_t treelet, const LaneMask& rays);
  void append(std::uint64_t step, std::int32_t treelet, const LaneMask& lanes, int rays);
};

/// Group stage: loads a group of rays, then their leaves; takes them through their treelet. Its blocks are
/// the pool's.
class GroupStage : public SharedTreeletStage {
 public:
  GroupStage(const StageContext& context, TreeContext& tree, SharedTreeletContext& rays);

  const char* name() const override { return "group stage"; }
  bool prepares() const override { return true; }
  void load(std::uint64_t step, int block) override;
  void prepare(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;

 private:
  /// State of a step, from its load to its end.
  struct State {
    LaneMask rays;
    std::int32_t treelet = TreeletQueues::kMixed;
    Needs needs;
  };
  State& state(std::uint64_t step) { return states_[step % states_.size()]; }
  void broadcast(std::uint64_t step, const State& state);

  std::vector<State> states_;
};

class SharedTreeletTraversal : public TreeTraversal {
 public:
  SharedTreeletTraversal(const StageContext& context, TreeContext& tree);

  void plan_first(const Plan& plan) override;
  void after_step(const Stage& stage, int block, const Plan& plan) override;
  bool has(const Stage& stage) const override { return &stage == &begin_ || &stage == &group_; }

 private:
  std::optional<int> take_block();

  cn::Machine& machine_;
  RayQueue& queue_;
  int most_planned_;  ///< maximum number of planned steps
  SharedTreeletContext rays_;
  BeginStage<SharedTreeletStage> begin_;
  GroupStage group_;
  int steps_left_ = 0;  ///< planned and not yet processed
};

}  // namespace path_tracer
