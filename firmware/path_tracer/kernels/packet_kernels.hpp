#pragma once

#include "firmware/path_tracer/kernels/traversal_kernels.hpp"
#include "firmware/path_tracer/tree/mono_node.hpp"

/// The poly programs of packets, which have nodes and triangles as mono operands.
namespace path_tracer {

/// Behind a TraversalRecord, whose part on the way through the tree packets do not use.
struct PacketRecord {
  vec3<double> minus_inverse{};  ///< of the direction (BoxRay)
  /// Upper half of the latest entry into a box that is of use, or kNoMore.
  std::int32_t limit = 0;
  std::int32_t light = 0;  ///< that a shadow ray begins at
};

/// Limit of a ray that is through: below every key.
inline constexpr std::int32_t kNoMore = -1;

/// A ray's key for a box: the upper half of the double at which it enters, or this, above every limit.
inline constexpr std::int32_t kNotMet = 0x7fffffff;

/// A ray's keys, in its PE's SRAM: the root's, then those of the children of the node that the packet is in
/// on each level.
class PacketKeys {
 public:
  PacketKeys() = default;
  /// @param span bytes(width) of them
  PacketKeys(cn::PolySpan span, int width) : offset_bytes_(span.offset_bytes), width_(width) {}

  static constexpr int bytes(int width) { return (2 + width * max_tree_levels(width)) / 2 * 8; }

  static constexpr int kRoot = 0;
  int place(int level, int child) const { return 1 + level * width_ + child; }
  int width() const { return width_; }

  PolyField<std::int32_t> operator[](int place) const {
    return {offset_bytes_ + place * int{sizeof(std::int32_t)}};
  }

 private:
  int offset_bytes_ = 0;
  int width_ = 0;
};

/// Behind the kernel `enter`.
struct BeginPacketArguments {
  PolyPointer<QueuedRay> ray;
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  PacketKeys keys;
  LaneMask* seeks_light = nullptr;
};

/// Which rays want what the packet comes to next.
struct WantArguments {
  PolyPointer<PacketRecord> packet;
  PacketKeys keys;
  int place = 0;
  /// Of a node: that its children's keys are to be cleared, as the kernel `visit` reaches only those who want
  /// it.
  bool is_node = false;
  int level = 0;
  LaneMask* wanting = nullptr;
};

/// Tests the boxes of a node's children.
struct VisitArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  const MonoNode* node = nullptr;
  PacketKeys keys;
  int level = 0;
  LaneMask* enters_first = nullptr;  ///< for each child: who enters no other one earlier
};

/// Tests triangles.
struct TestLeafArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  const TriangleRecord* triangles = nullptr;
  int count = 0;
  double reach = 0;  ///< of the scene (triangle_record.hpp)
};

struct PacketKernels {
  cn::Kernel<BeginPacketArguments> begin;
  cn::Kernel<WantArguments> want;
  cn::Kernel<VisitArguments> visit;
  cn::Kernel<TestLeafArguments> test_leaf;
};

}  // namespace path_tracer
