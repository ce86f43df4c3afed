#pragma once

#include <array>

#include "firmware/cn/language/kernel.hpp"
#include "firmware/cn/simd/level.hpp"
#include "firmware/path_tracer/records/traversal_record.hpp"

/// The poly programs that take rays through the tree, as kernels.hpp has those of the other bins.
namespace path_tracer {

using cn::LaneMask;
using cn::Level;
using cn::MonoAddress;
using cn::PolyField;
using cn::PolyPointer;

/// What PEs hold of the tree.
struct TreeInSram {
  TreeShape shape;
  int resident_offset = 0;  ///< of the resident nodes, in bytes
  int treelet_offset = 0;   ///< of the treelet that was loaded
};

/// Behind the stages that make rays: packs them into the ray bin.
struct EnqueueArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the lanes with a ray
  PolyPointer<QueuedRay> ray;
  PolyField<MonoAddress> light_place;  ///< of the light that shadow rays are sent to
  MonoAddress lights = 0;
  int first_slot = 0;
  MonoAddress first_place = 0;  ///< for number 0
  PolyField<MonoAddress> place;
};

/// Which of the rays in the ray bin each idle PE takes.
struct TakeRaysArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the idle PEs
  std::int32_t rays = 0;           ///< that there are
  MonoAddress first_place = 0;
  PolyField<MonoAddress> place;
  LaneMask* takes = nullptr;
};

/// A ray begins at the root, a shadow ray at its light.
struct EnterArguments {
  PolyPointer<QueuedRay> ray;
  int first_light_run = 0;  ///< in the triangle array
  PolyPointer<TraversalRecord> record;
  PolyField<std::int32_t> treelet;  ///< is set to none
};

/// Before the loads: where each ray's leaf and treelet lie.
struct LocateArguments {
  PolyPointer<TraversalRecord> record;
  TreeShape shape;
  MonoAddress triangles = 0;
  MonoAddress nodes = 0;
  PolyField<MonoAddress> leaf_place;
  PolyField<MonoAddress> treelet_place;
  PolyField<std::int32_t> treelet;  ///< its first slot
  LaneMask* needs_leaf = nullptr;
  LaneMask* needs_treelet = nullptr;
};

/// Tests the leaf, then goes on to the next leaf or to where the loaded nodes end.
struct TraverseArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<TriangleRecord> leaf;
  PolyField<std::int32_t> treelet;
  TreeInSram tree;
  double reach = 0;                       ///< of the scene (triangle_record.hpp)
  const LaneMask* loaded_leaf = nullptr;  ///< nothing when no PE has one
  LaneMask* alive = nullptr;
};

/// Of rays that are through: the hit, as the ray bin's own kernel leaves it, and where it goes.
struct FinishArguments {
  PolyPointer<TraversalRecord> record;
  MonoAddress surfaces = 0;
  MonoAddress hits = 0;            ///< intersection bin
  MonoAddress surface_places = 0;  ///< bin
  PolyPointer<HitRecord> hit;
  PolyField<MonoAddress> surface_place;
  PolyField<MonoAddress> hit_to;
  PolyField<MonoAddress> surface_place_to;
};

/// Where the rays that go on save to: behind the others in the ring of the traversal bin.
struct AppendRaysArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the lanes that go on
  MonoAddress bin = 0;
  int record_bytes = 0;
  std::int32_t tail = 0;      ///< place of number 0 in the ring
  std::int32_t capacity = 0;  ///< of the ring, in rays
  PolyField<MonoAddress> place;
};

/// Intersection bin: which slots hit something.
struct RecallArguments {
  PolyField<MonoAddress> surface_place;
  LaneMask* hit_something = nullptr;
};

/// Bits of the greatest of `numbers` numbers from 0 on.
inline int bits_of(int numbers) {
  int bits = 0;
  while (((numbers - 1) >> bits) > 0) ++bits;
  return bits;
}

/// The least value that a PE holds, for the control unit (cn::keep_least).
struct LeastArguments {
  PolyField<std::int32_t> value;
  int bits = 0;
  std::int32_t* least = nullptr;
};

/// Which PEs hold a value.
struct EqualArguments {
  PolyField<std::int32_t> value;
  std::int32_t wanted = 0;
  LaneMask* equal = nullptr;
};

/// A treelet into all PEs, as mono operands that they store.
struct BroadcastArguments {
  const std::uint64_t* word = nullptr;
  int words = 0;
  int to_offset = 0;
};

/// Where rays of one treelet save to (TreeletQueues::Room).
struct AppendToBlocksArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the rays; not of a single one
  int rays = 0;
  int room = 0;  ///< for so many of them
  MonoAddress address = 0;
  MonoAddress next_address = 0;  ///< for the others
  int record_bytes = 0;
  PolyField<MonoAddress> place;
};

/// By NodeFormat, where NodeLayout::has_kernel().
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
