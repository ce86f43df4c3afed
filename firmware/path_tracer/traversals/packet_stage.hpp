#pragma once

#include "firmware/path_tracer/traversals/packet_rays.hpp"
#include "firmware/path_tracer/traversals/tree_search.hpp"

/// Coherent packets, for comparison: a block of rays shares one traversal (Wald, Slusallek, Benthin, Wagner,
/// "Interactive Rendering with Coherent Ray Tracing", Eurographics 2001; Boulos et al., "Packet-based Whitted
/// and Distribution Ray Tracing", GI 2007). A node is visited if one ray of the block needs it.
namespace path_tracer {

/// Packet stage: takes a block of rays through the whole tree. Its blocks are those of the ray queue.
class PacketStage : public PacketBase {
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

  void walk();
  LaneMask rays_that_want(const Entry& entry);
  void visit(const Entry& entry, const LaneMask& rays);
  void push_children(const MonoNode& node, int level, const LaneMask* enters_first);

  PacketBlock block_;  ///< in process
  PacketKeys keys_;
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
