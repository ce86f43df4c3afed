#pragma once

#include "firmware/path_tracer/traversals/packet_of_blocks.hpp"

namespace path_tracer {

/// Streams of rays that are filtered at each node, for comparison (Wald, Gribble, Boulos, Kensler, "SIMD Ray
/// Stream Tracing", technical report UUSCI-2007-012, University of Utah 2007). Each PE holds several rays of
/// the stream and filters its own: a child gets the set of those that meet its box, and PEs take the next ray
/// of their set each, whichever that is, so that few PEs are idle. No ray moves to another PE: the report
/// gathers rays from a cache that all lanes reach, where here each would come from mono memory.
class RayStreamStage : public PacketWalkStage {
 public:
  RayStreamStage(const StageContext& context, TreeContext& tree, PacketOfBlocks& rays);

 protected:
  void add_block(int number) override;
  void walk(int blocks) override;

 private:
  /// A node or leaf with active rays, on the control unit's stack.
  struct Entry {
    ChildReference reference;
    int level = 0;  ///< of the node
    int place = 0;  ///< of its set
  };
  void visit(const Entry& entry);
  void test_leaf_set(const Entry& entry);

  const RayStreamKernels& ray_stream_kernels_;
  StreamRays stream_;
  std::vector<Entry> stack_;
};

}  // namespace path_tracer
