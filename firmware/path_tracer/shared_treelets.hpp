#pragma once

#include "firmware/path_tracer/tree_stage.hpp"
#include "firmware/path_tracer/treelet_queues.hpp"

/// Rays grouped by the treelet that they need next (queues at treelets: Pharr, Kolb, Gershbein, Hanrahan,
/// "Rendering Complex Scenes with Memory-Coherent Ray Tracing", SIGGRAPH 1997; Aila, Karras, HPG 2010): all
/// rays of a block go through the same one.
///
/// It comes into the PEs word by word, as a mono operand that a kernel stores. The PIO engine would serve PE
/// after PE though all ask for the same; where it consolidates equal addresses
/// (pio.consolidate_equal_addresses) it would still take a request of its set-up time, about what the kernel
/// takes for a small treelet.
///
/// The control unit learns which treelets a block's rays need next by reductions, the least of them first
/// (cn::keep_least), so that sorting a block takes time by how many different ones there are.
namespace path_tracer {

/// The rays in SRAM and the queues that they go round.
struct SharedTreeletContext {
  SharedTreeletContext(cn::Machine& machine, const ProgramConfig& config, const Layout& layout);

  TransferRing records;  ///< a buffer stays a step's from its load to the end of its save
  TreeletQueues queues;
  PolyField<std::int32_t> number;
  int slot_bits;  ///< of a node's slot
};

/// What both stages do at their ends: rays that go on are saved to the queues.
class SharedTreeletStage : public TreeStage {
 public:
  SharedTreeletStage(const StageContext& context, TreeContext& tree, SharedTreeletContext& rays)
      : TreeStage(context, tree), rays_(rays) {}
  void save(std::uint64_t step, int block) override;

 protected:
  PolyPointer<TraversalRecord> record(std::uint64_t step) const {
    return PolyPointer<TraversalRecord>(rays_.records.buffer(step));
  }
  void traverse_and_sort(std::uint64_t step, const LaneMask& rays, const Needs& needs, std::size_t pass);

  SharedTreeletContext& rays_;

 private:
  PolyField<MonoAddress> record_to(std::uint64_t step) const;
  void sort(std::uint64_t step, int rays);
  std::int32_t least_treelet(std::uint64_t step, const LaneMask& rays);
  LaneMask rays_of_treelet(std::uint64_t step, std::int32_t treelet, const LaneMask& rays);
  void append(std::uint64_t step, std::int32_t treelet, const LaneMask& lanes, int rays);

  LaneMask alive_;
};

/// Ray bin: takes rays as far as the resident nodes go, into the queues. Its blocks are the ray bin's,
/// packed.
class BeginGroupsStage : public SharedTreeletStage {
 public:
  using SharedTreeletStage::SharedTreeletStage;

  const char* bin() const override { return "ray bin"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
};

/// Queues: loads rays, then their leaves, takes them through their treelet. Its blocks are the pool's.
class GroupStage : public SharedTreeletStage {
 public:
  GroupStage(const StageContext& context, TreeContext& tree, SharedTreeletContext& rays);

  const char* bin() const override { return "treelet queues"; }
  bool prepares() const override { return true; }
  void load(std::uint64_t step, int block) override;
  void prepare(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;

 private:
  /// Of a step, from its load to its end.
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

  void after_step(const Stage& stage, int block, const Plan& plan) override;
  bool has(const Stage& stage) const override { return &stage == &begin_ || &stage == &group_; }

 protected:
  void plan_first(const Plan& plan) override;

 private:
  std::optional<int> take_block();

  cn::Machine& machine_;
  RayQueue& queue_;
  int most_planned_;  ///< steps, before blocks that are partly full are taken
  SharedTreeletContext rays_;
  BeginGroupsStage begin_;
  GroupStage group_;
  int steps_left_ = 0;  ///< that are planned
};

}  // namespace path_tracer
