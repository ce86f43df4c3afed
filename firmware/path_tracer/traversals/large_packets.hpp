#pragma once

#include "firmware/path_tracer/traversals/packet_bounds.hpp"
#include "firmware/path_tracer/traversals/packet_of_blocks.hpp"

namespace path_tracer {

/// Large packets, for comparison: several blocks of rays share one traversal. A child's box is culled for the
/// whole packet by the interval of its rays; otherwise block after block is tested until one has a ray that
/// meets it, from the first block on that is active in the node (Wald, Boulos, Shirley, "Ray Tracing
/// Deformable Scenes Using Dynamic Bounding Volume Hierarchies", ACM TOG 2007, whose blocks are single rays;
/// packet_bounds.hpp).
class LargePacketStage : public PacketWalkStage {
 public:
  LargePacketStage(const StageContext& context, TreeContext& tree, PacketOfBlocks& rays);

 protected:
  void add_block(int number) override;
  void walk(int blocks) override;

 private:
  /// A node or leaf that the packet has still to visit, on the control unit's stack.
  struct Entry {
    ChildReference reference;
    int first_block = 0;        ///< that is active: none before it has a ray that meets the box
    cn::mono4<double> lower{};  ///< by axis, the last one twice
    cn::mono4<double> upper{};
  };
  void take_bounds();
  void visit(const Entry& entry, int blocks);
  /// Finds the first active block of each child, -1 for none, and how many of its rays enter it first.
  void find_first_blocks(const MonoNode& node, int from_block, int blocks, int* first_block, int* votes);
  void test_leaf_from_first(const Entry& entry, int blocks);

  const LargePacketKernels& large_packet_kernels_;
  PolyField<std::int32_t> bounds_at_;
  PacketBounds bounds_;
  std::vector<Entry> stack_;
};

}  // namespace path_tracer
