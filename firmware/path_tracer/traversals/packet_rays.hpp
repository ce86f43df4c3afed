#pragma once

#include <vector>

#include "firmware/path_tracer/kernels/packet_kernels.hpp"
#include "firmware/path_tracer/traversals/tree_stage.hpp"

/// Shared by the traversals in which the control unit goes through the tree for many rays at once, broadcasts
/// nodes and triangles to all PEs, and no PE loads any of them.
namespace path_tracer {

/// A block of rays in SRAM.
struct PacketBlock {
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  LaneMask rays;
};

/// A child of a node, by how many rays enter it first.
struct VotedChild {
  int child = 0;
  int votes = 0;
};

/// A stage that takes packets through the tree.
class PacketBase : public TreeStage {
 public:
  PacketBase(const StageContext& context, TreeContext& tree);

 protected:
  /// Prepares rays that were loaded, and tests the lights of shadow rays.
  /// @param keys of the rays; nullptr for a traversal without
  void begin(std::uint64_t step, const PacketBlock& block, const PacketKeys* keys);
  MonoNode read(std::int32_t slot);
  /// Charges the order of children and sorts them: the last is to be visited first.
  void sort_children(std::vector<VotedChild>& children);
  void charge_pop();
  void charge_push(int entries);
  void test_leaf(std::int32_t first_triangle, std::int32_t count, const PacketBlock& block,
                 const LaneMask& rays);
  const TriangleRecord* triangles(std::int32_t first, std::int32_t count) {
    return read_triangles(context_.machine, context_.layout, first, count);
  }
  int width() const { return tree_.tree.shape.layout.width; }

  const PacketKernels& packet_kernels_;

 private:
  void test_lights(const PacketBlock& block, LaneMask seeks_light);
  std::int32_t least_light(const PacketBlock& block, const LaneMask& rays);
  LaneMask rays_with_light(std::int32_t light, const PacketBlock& block, const LaneMask& rays);

  MonoNodes nodes_;
};

}  // namespace path_tracer
