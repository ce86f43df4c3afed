#pragma once

#include "firmware/path_tracer/kernels/traversal_kernels.hpp"
#include "firmware/path_tracer/tree/mono_node.hpp"

/// The poly programs of packets. Nodes and triangles are their mono operands.
namespace path_tracer {

/// A packet's part of a ray, beside its TraversalRecord. Packets do not use that record's state of the
/// traversal.
struct PacketRecord {
  vec3<double> minus_inverse{};  ///< of the direction (BoxRay)
  /// Upper half of the latest entry into a box that matters, or kNoMore.
  std::int32_t limit = 0;
  std::int32_t light = 0;  ///< number of a shadow ray's light
};

/// Limit of a finished ray: below every key.
inline constexpr std::int32_t kNoMore = -1;

/// A ray's key for a box that it misses: above every limit. Otherwise the key is the upper half of the double
/// at which the ray enters.
inline constexpr std::int32_t kNotMet = 0x7fffffff;

/// A ray's keys in its PE's SRAM: the root's, then for each level those of the children of the packet's node.
class PacketKeys {
 public:
  PacketKeys() = default;
  /// @param span of bytes(width) bytes
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

/// After the kernel `enter`: prepares the rays of a packet.
struct BeginPacketArguments {
  PolyPointer<QueuedRay> ray;
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  bool has_keys = true;
  PacketKeys keys;
  LaneMask* seeks_light = nullptr;
};

/// Tells which rays need the packet's next node or leaf.
struct WantArguments {
  PolyPointer<PacketRecord> packet;
  PacketKeys keys;
  int place = 0;
  /// Whether the next is a node. Then its children's keys are cleared, because the kernel `visit` runs only
  /// for the rays that need it.
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
  LaneMask* enters_first = nullptr;  ///< for each child: the rays that enter no other child earlier
};

/// Tests triangles.
struct TestLeafArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  const TriangleRecord* triangles = nullptr;
  int count = 0;
  double reach = 0;  ///< of the scene (triangle_record.hpp)
  Layers layers;
};

struct PacketKernels {
  cn::Kernel<BeginPacketArguments> begin;
  cn::Kernel<WantArguments> want;
  cn::Kernel<VisitArguments> visit;
  cn::Kernel<TestLeafArguments> test_leaf;
};

}  // namespace path_tracer
