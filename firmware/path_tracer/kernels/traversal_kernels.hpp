#pragma once

#include <array>

#include "firmware/cn/language/kernel.hpp"
#include "firmware/cn/simd/level.hpp"
#include "firmware/path_tracer/records/traversal_record.hpp"

/// The poly programs of tree traversals; kernels.hpp has the others.
namespace path_tracer {

using cn::LaneMask;
using cn::Level;
using cn::MonoAddress;
using cn::PolyField;
using cn::PolyPointer;

/// An array of records with tails (records/tails.hpp) in mono memory.
struct MonoRecords {
  MonoAddress first = 0;
  int record_bytes = 0;
};

/// The part of the tree in the PEs' SRAM.
struct TreeInSram {
  TreeShape shape;
  int resident_offset = 0;  ///< of the resident nodes
  int treelet_offset = 0;   ///< of the loaded treelet
};

/// After the stages that make rays: packs the rays into the ray queue.
struct EnqueueArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the lanes with a ray
  PolyPointer<QueuedRay> ray;
  PolyField<MonoAddress> light_place;  ///< place of the light of each shadow ray
  MonoAddress lights = 0;
  int first_slot = 0;
  const PolyField<std::int32_t>* slots = nullptr;  ///< of each PE; nullptr: `first_slot` and those behind it
  MonoAddress first_place = 0;                     ///< for number 0
  PolyField<MonoAddress> place;
};

/// Gives each idle PE one of the next rays in the ray queue.
struct TakeRaysArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the idle PEs
  std::int32_t rays = 0;           ///< number of rays left
  MonoAddress first_place = 0;
  PolyField<MonoAddress> place;
  LaneMask* takes = nullptr;
};

/// Begins the traversal: a segment at the root, a shadow ray at its light.
struct EnterArguments {
  PolyPointer<QueuedRay> ray;
  int first_light_run = 0;  ///< in the triangle array
  PolyPointer<TraversalRecord> record;
  PolyField<std::int32_t> treelet;  ///< set to kNoTreelet
};

/// Before the loads: the places of each ray's leaf and treelet.
struct LocateArguments {
  PolyPointer<TraversalRecord> record;
  TreeShape shape;
  MonoAddress triangles = 0;
  int triangle_bytes = sizeof(TriangleRecord);  ///< of each triangle (Layers)
  MonoAddress nodes = 0;
  PolyField<MonoAddress> leaf_place;
  PolyField<MonoAddress> treelet_place;
  PolyField<std::int32_t> treelet;  ///< its first slot
  LaneMask* needs_leaf = nullptr;
  LaneMask* needs_treelet = nullptr;
};

/// Tests the leaf, then traverses to the next leaf or to the end of the loaded nodes.
struct TraverseArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<TriangleRecord> leaf;
  PolyField<std::int32_t> treelet;
  TreeInSram tree;
  double reach = 0;  ///< of the scene (triangle_record.hpp)
  Layers layers;
  const LaneMask* loaded_leaf = nullptr;  ///< nullptr if no PE has a leaf
  LaneMask* alive = nullptr;
};

/// Writes the hit of each finished ray, and where it is saved.
struct FinishArguments {
  PolyPointer<TraversalRecord> record;
  MonoRecords surfaces;
  MonoRecords hits;                ///< intersection bin
  bool hit_has_tail = false;       ///< ArrivalRecord
  MonoAddress surface_places = 0;  ///< bin
  PolyPointer<HitRecord> hit;
  PolyField<MonoAddress> surface_place;
  PolyField<MonoAddress> hit_to;
  PolyField<MonoAddress> surface_place_to;
};

/// Writes where the remaining rays are saved: behind the others in the ring of the traversal bin.
struct AppendRaysArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the lanes with a remaining ray
  MonoAddress bin = 0;
  int record_bytes = 0;
  std::int32_t tail = 0;      ///< place of number 0 in the ring
  std::int32_t capacity = 0;  ///< of the ring, in rays
  PolyField<MonoAddress> place;
};

/// Before the intersection stage: which slots' rays hit something.
struct RecallArguments {
  PolyField<MonoAddress> surface_place;
  LaneMask* hit_something = nullptr;
};

/// Returns the number of bits of the greatest of `numbers` numbers from 0 on.
inline int bits_of(int numbers) {
  int bits = 0;
  while (((numbers - 1) >> bits) > 0) ++bits;
  return bits;
}

/// Gives the control unit the least value that a PE holds (cn::keep_least).
struct LeastArguments {
  PolyField<std::int32_t> value;
  int bits = 0;
  std::int32_t* least = nullptr;
};

/// Tells which PEs hold a value.
struct EqualArguments {
  PolyField<std::int32_t> value;
  std::int32_t wanted = 0;
  LaneMask* equal = nullptr;
};

/// Stores a treelet in all PEs, word by word as mono operands.
struct BroadcastArguments {
  const std::uint64_t* word = nullptr;
  int words = 0;
  int to_offset = 0;
};

/// Writes where the rays of one treelet are saved (TreeletQueues::Room).
struct AppendToBlocksArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the rays, if there are several
  int rays = 0;
  int room = 0;  ///< number of rays that go to `address`
  MonoAddress address = 0;
  MonoAddress next_address = 0;  ///< for the other rays
  int record_bytes = 0;
  PolyField<MonoAddress> place;
};

/// One kernel for each NodeFormat, where NodeLayout::has_kernel().
using TraverseKernels = std::array<cn::Kernel<TraverseArguments>, kNodeFormats>;

struct TraversalKernels {
  cn::Kernel<EnqueueArguments> enqueue;
  cn::Kernel<TakeRaysArguments> take_rays;
  cn::Kernel<EnterArguments> enter;
  cn::Kernel<LocateArguments> locate;
  TraverseKernels traverse[kNodeWidths];
  cn::Kernel<FinishArguments> finish;
  cn::Kernel<AppendRaysArguments> append_rays;
  cn::Kernel<RecallArguments> recall;
  cn::Kernel<LeastArguments> least;
  cn::Kernel<EqualArguments> equal;
  cn::Kernel<BroadcastArguments> broadcast;
  cn::Kernel<AppendToBlocksArguments> append_to_blocks;

  const cn::Kernel<TraverseArguments>& traverse_through(const NodeLayout& layout) const {
    return traverse[layout.width_number()][static_cast<std::size_t>(layout.format)];
  }
};

}  // namespace path_tracer
