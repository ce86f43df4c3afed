#pragma once

#include "firmware/path_tracer/kernels/packet_kernels.hpp"

/// The poly programs of large packets, beside those of packets.
namespace path_tracer {

/// The bounds of a packet: for each axis the least origin, the greatest one, and the same of -1 / direction.
inline constexpr int kPacketBounds = 4 * kAxes;

/// Bits of a bound: the upper ones of a double, in an order in which they compare as integers.
inline constexpr int kBoundBits = 31;

/// Adds a block's rays to the bounds of each PE's rays.
struct BoundArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  PolyField<std::int32_t> bounds;  ///< the first of kPacketBounds; greatest ones as distances from the top
  bool is_first = false;           ///< block of the packet
};

/// Gives the control unit the bounds of all PEs' rays.
struct KeepBoundsArguments {
  PolyField<std::int32_t> bounds;
  std::int32_t* least = nullptr;  ///< kPacketBounds of them
};

/// Tests the boxes of a node's children.
struct MeetArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  const MonoNode* node = nullptr;
  LaneMask* meets = nullptr;         ///< for each child: the rays that meet its box
  LaneMask* enters_first = nullptr;  ///< for each child: those that enter no other child earlier
};

/// Tests the box of one child.
struct MeetChildArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<PacketRecord> packet;
  cn::mono4<double> lower{};  ///< by axis, the last one twice
  cn::mono4<double> upper{};
  LaneMask* meets = nullptr;
};

struct LargePacketKernels {
  cn::Kernel<BoundArguments> bound;
  cn::Kernel<KeepBoundsArguments> keep_bounds;
  cn::Kernel<MeetArguments> meet;
  cn::Kernel<MeetChildArguments> meet_child;
};

}  // namespace path_tracer
