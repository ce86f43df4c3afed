#pragma once

#include "firmware/path_tracer/kernels/packet_kernels.hpp"
#include "firmware/path_tracer/traversals/tree_search.hpp"
#include "firmware/path_tracer/traversals/tree_stage.hpp"

/// Coherent packets, for comparison: a block of rays shares one traversal (Wald, Slusallek, Benthin, Wagner,
/// "Interactive Rendering with Coherent Ray Tracing", Eurographics 2001; Boulos et al., "Packet-based Whitted
/// and Distribution Ray Tracing", GI 2007). The control unit traverses the tree and broadcasts nodes and
/// triangles to all PEs; no PE loads any of them. A node is visited if one ray of the block needs it.
namespace path_tracer {

/// Packet stage: takes a block of rays through the whole tree. Its blocks are those of the ray queue.
class PacketStage : public TreeStage {
 public:
  PacketStage(const StageContext& context, TreeContext& tree);

  const char* name() const override { return "packet stage"; }
  void load(std::uint64_t step, int block) override;
  void process(std::uint64_t step, int block) override;
  void save(std::uint64_t step, int /*block*/) override { save_hits(step); }

 private:
  /// A node or leaf that the packet has still to visit, on the control unit's stack.
  struct Entry {
    ChildReference reference;
    int level = 0;  ///< of the node
    int place = 0;  ///< place of the rays' keys for it
  };

  LaneMask begin(std::uint64_t step);
  void test_lights(LaneMask seeks_light);
  std::int32_t least_light(const LaneMask& rays);
  LaneMask rays_with_light(std::int32_t light, const LaneMask& rays);
  void walk();
  LaneMask rays_that_want(const Entry& entry);
  void visit(const Entry& entry, const LaneMask& rays);
  void push_children(const MonoNode& node, int level, const LaneMask* enters_first);
  void test_leaf(std::int32_t first_triangle, std::int32_t count, const LaneMask& rays);

  const PacketKernels& packet_kernels_;
  PolyPointer<TraversalRecord> record_;  ///< of the block in process
  PolyPointer<PacketRecord> packet_;
  PacketKeys keys_;
  MonoNodes nodes_;
  LaneMask rays_;
  std::vector<Entry> stack_;
};

class PacketTraversal : public TreeTraversal {
 public:
  PacketTraversal(const StageContext& context, TreeContext& tree)
      : queue_(tree.queue), num_pes_(context.machine.num_pes()), stage_(context, tree) {}

  void plan_first(const Plan& plan) override;
  void after_step(const Stage& /*stage*/, int /*block*/, const Plan& /*plan*/) override {}
  bool has(const Stage& stage) const override { return &stage == &stage_; }

 private:
  RayQueue& queue_;
  int num_pes_;
  PacketStage stage_;
};

}  // namespace path_tracer
