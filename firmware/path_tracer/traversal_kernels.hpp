#pragma once

#include "firmware/cn/kernel.hpp"
#include "firmware/cn/level.hpp"
#include "firmware/path_tracer/traversal_record.hpp"

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

/// Ray bin: a ray begins at the root, a shadow ray at its light.
struct BeginArguments {
  PolyPointer<RayRecord> ray;
  PolyField<MonoAddress> light_place;  ///< of the light that a shadow ray was sent to
  MonoAddress lights = 0;
  int first_light_run = 0;  ///< in the triangle array
  int first_slot = 0;
  TreeInSram tree;
  PolyPointer<TraversalRecord> record;
  LaneMask* alive = nullptr;
};

/// Traversal bin, before the loads: where each ray's leaf and treelet lie.
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

/// Traversal bin: tests the leaf, then goes on to the next leaf or to where the loaded nodes end.
struct TraverseArguments {
  PolyPointer<TraversalRecord> record;
  PolyPointer<TriangleRecord> leaf;
  PolyField<std::int32_t> treelet;
  TreeInSram tree;
  double reach = 0;  ///< of the scene (triangle_record.hpp)
  bool tests_leaves = true;  ///< false when no PE has one
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

struct TraversalKernels {
  cn::Kernel<BeginArguments> begin[kNodeFormats];  ///< by NodeFormat
  cn::Kernel<LocateArguments> locate;
  cn::Kernel<TraverseArguments> traverse[kNodeFormats];
  cn::Kernel<FinishArguments> finish;
  cn::Kernel<AppendRaysArguments> append_rays;
  cn::Kernel<RecallArguments> recall;
};

}  // namespace path_tracer
