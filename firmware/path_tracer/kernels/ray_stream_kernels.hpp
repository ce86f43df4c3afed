#pragma once

#include "firmware/path_tracer/kernels/packet_kernels.hpp"

/// The poly programs of ray streams, beside those of packets.
namespace path_tracer {

/// A ray of a stream in a PE's SRAM.
struct StreamRay {
  TraversalRecord record;
  PacketRecord packet;
};

/// The rays of a stream: the same number in each PE, side by side. A set of a PE's rays is a word with a bit
/// for each.
struct StreamRays {
  int offset_bytes = 0;  ///< of the first
  PacketKeys sets;       ///< of rays that are active in the root, and by level in the children of its node
};

/// Before the root: the rays that a PE has.
struct FillSetArguments {
  StreamRays rays;
  int block = 0;
  bool is_first = false;
};

/// Filters the rays that are active in a node into the sets of its children.
struct FilterArguments {
  StreamRays rays;
  const MonoNode* node = nullptr;
  int place = 0;                     ///< of the node's set
  int level = 0;                     ///< of the node
  LaneMask* active = nullptr;        ///< for each child: PEs that have a ray in it
  LaneMask* enters_first = nullptr;  ///< for each child: PEs whose first ray enters no other child earlier
};

/// Tests triangles against the rays of a set.
struct TestSetArguments {
  StreamRays rays;
  int place = 0;
  const TriangleRecord* triangles = nullptr;
  int count = 0;
  double reach = 0;  ///< of the scene (triangle_record.hpp)
  Layers layers;
};

struct RayStreamKernels {
  cn::Kernel<FillSetArguments> fill_set;
  cn::Kernel<FilterArguments> filter;
  cn::Kernel<TestSetArguments> test_set;
};

}  // namespace path_tracer
