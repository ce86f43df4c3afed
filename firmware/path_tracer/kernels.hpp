#pragma once

#include "firmware/cn/kernel.hpp"
#include "firmware/path_tracer/program.hpp"

/// The poly programs of the path tracer: their arguments and the table of entry points. Poly pointers name
/// SRAM, plain pointers mono memory that the control unit reads, `LaneMask*` the conditions a kernel leaves
/// to the control unit.
namespace path_tracer {

using cn::LaneMask;
using cn::MonoAddress;
using cn::PolyField;
using cn::PolyPointer;

/// Ray stage: the nearest triangle along each ray, tested one by one.
struct IntersectArguments {
  PolyPointer<RayRecord> ray;
  const TriangleRecord* triangles = nullptr;
  int triangle_count = 0;
  MonoAddress surfaces = 0;
  PolyPointer<HitRecord> hit;
  PolyField<MonoAddress> surface_place;  ///< kept for the intersection stage's gather
  LaneMask* hit_something = nullptr;
};

/// Intersection stage: shading details and the new direction.
struct ScatterArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<SurfaceRecord> surface;
  PolyPointer<PathRecord> path;
  std::uint64_t seed = 0;
  int roulette_start = 0;
  double max_survival = 0;
  bool light_by_shadow_rays = false;  ///< then emission counts where the camera sees it only
  const double* light_cdf = nullptr;
  int light_count = 0;
  MonoAddress lights = 0;
  PolyPointer<ScatterRecord> scatter;
  PolyPointer<ShadowRecord> shadow;
  PolyField<MonoAddress> light_place;  ///< kept for the shadow stage's gather
  LaneMask* wants_light = nullptr;
};

/// Shadow stage: light from one point of one light, if nothing is in between.
struct ShadowArguments {
  PolyPointer<ShadowRecord> shadow;
  PolyPointer<LightRecord> light;
  const TriangleRecord* triangles = nullptr;
  int triangle_count = 0;
  PolyPointer<DirectLightRecord> direct_light;
};

/// Path stage, first half: the vertex, and which paths end here.
struct AppendArguments {
  PolyPointer<PathRecord> path;
  PolyPointer<ScatterRecord> scatter;
  PolyPointer<DirectLightRecord> direct_light;
  const LaneMask* has_direct_light = nullptr;
  MonoAddress block_vertices = 0;  ///< of the block's first slot
  int slot_vertices = 0;
  int first_slot = 0;
  PolyPointer<VertexRecord> vertex;
  PolyField<MonoAddress> vertex_place;
  PolyPointer<FinishedRecord> finished_record;
  LaneMask* ended = nullptr;
  LaneMask* finished = nullptr;  ///< ended, or the slot is full
};

/// Path stage, second half: the ray that goes on, or the next camera ray in the place of a path that ended.
struct ReplaceArguments {
  PolyPointer<PathRecord> path;
  PolyPointer<ScatterRecord> scatter;
  PolyField<std::int32_t> number;  ///< ascending numbers of the lanes that ended
  const LaneMask* ended = nullptr;
  const LaneMask* finished = nullptr;
  const CameraRecord* camera = nullptr;
  std::uint64_t seed = 0;
  std::int32_t next_pixel = 0;  ///< of the camera ray with number 0
  std::int32_t next_sample = 0;
  std::int32_t remaining = 0;  ///< camera rays there still are, at most the number of PEs
  PolyPointer<PathRecord> next_path;
  PolyPointer<RayRecord> ray;
  LaneMask* live = nullptr;
};

/// Path stage: where the lanes that finished save to, packed by their ascending numbers.
struct FinishedPlaceArguments {
  PolyField<std::int32_t> number;
  MonoAddress next_finished = 0;
  PolyField<MonoAddress> finished_place;
};

/// Radiance stage, list step: where the vertices are, and which loads of kVerticesPerLoad each path needs.
struct ListArguments {
  PolyPointer<FinishedRecord> entry;
  MonoAddress vertices = 0;
  MonoAddress folds = 0;
  int slot_vertices = 0;
  PolyField<MonoAddress> vertex_place;  ///< kept for the fold steps
  PolyField<MonoAddress> fold_place;
  LaneMask* needs_load = nullptr;  ///< slot_vertices / kVerticesPerLoad masks
  LaneMask* folded = nullptr;
  LaneMask* flushed = nullptr;
};

/// Radiance stage, fold step: adds kVerticesPerLoad vertices of each path.
struct FoldArguments {
  PolyPointer<FinishedRecord> entry;
  PolyPointer<VertexRecord> vertices;
  PolyPointer<FoldRecord> earlier;  ///< read in the first step by paths that were folded before
  PolyPointer<FoldRecord> sum;      ///< carried from step to step
  int first_vertex = 0;
  PolyPointer<RadianceRecord> radiance;  ///< written in every step; the last one counts
  PolyPointer<FoldRecord> flushed;       ///< the same, for paths that go on
};

struct Kernels {
  cn::Kernel<IntersectArguments> intersect;
  cn::Kernel<ScatterArguments> scatter;
  cn::Kernel<ShadowArguments> shadow;
  cn::Kernel<AppendArguments> append;
  cn::Kernel<ReplaceArguments> replace;
  cn::Kernel<FinishedPlaceArguments> finished_place;
  cn::Kernel<ListArguments> list;
  cn::Kernel<FoldArguments> fold;
};

/// Levels of the x86-64 instruction set that the kernels are built for; the same bits come from each.
enum class Level : std::uint8_t { x86_64_v2, x86_64_v3, x86_64_v4 };

const Kernels& kernels(Level level);

/// The same, built to report their SRAM accesses to a cn::AccessObserver; for every x86-64 machine.
const Kernels& observed_kernels();

}  // namespace path_tracer
