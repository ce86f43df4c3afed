#pragma once

#include "firmware/cn/language/kernel.hpp"
#include "firmware/cn/simd/level.hpp"
#include "firmware/path_tracer/geometry/triangle_sieve.hpp"
#include "firmware/path_tracer/kernels/traversal_kernels.hpp"
#include "firmware/path_tracer/program/program.hpp"

/// The poly programs of the path tracer: their arguments and the table of entry points. Poly pointers name
/// SRAM, plain pointers mono memory that the control unit reads, `LaneMask*` the conditions a kernel leaves
/// to the control unit.
namespace path_tracer {

/// Ray stage: the nearest triangle along each ray, tested one by one.
struct IntersectArguments {
  PolyPointer<RayRecord> ray;
  const TriangleRecord* triangles = nullptr;
  int triangle_count = 0;
  const TriangleSieve* sieve = nullptr;  ///< of those triangles, for the host
  double reach = 0;                      ///< of the scene (triangle_record.hpp)
  MonoAddress surfaces = 0;
  PolyPointer<HitRecord> hit;
  PolyField<MonoAddress> surface_place;  ///< kept for the intersection stage's gather
  LaneMask* hit_something = nullptr;
};

/// Intersection stage, segments: shading details, the new direction, and a shadow ray to the light chosen
/// before.
struct ScatterArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<SurfaceRecord> surface;
  PolyPointer<PathRecord> path;
  PolyPointer<LightRecord> light;
  Sampler sampler = Sampler::philox;
  LightSampling light_sampling = LightSampling::area;
  std::uint64_t seed = 0;
  int roulette_start = 0;
  double max_survival = 0;
  bool casts_shadow_rays = false;  ///< then emission counts where the camera sees it only
  bool cull_shadow_rays = false;
  PolyPointer<ScatterRecord> scatter;
  PolyPointer<RayRecord> shadow_ray;
  PolyPointer<LightingRecord> lighting;
  LaneMask* casts = nullptr;  ///< the slot's next ray is the shadow ray
};

/// Intersection stage, shadow rays: direct light, if the light was what they hit.
struct IlluminateArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<SurfaceRecord> surface;
  PolyPointer<LightingRecord> lighting;
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
  const double* light_cdf = nullptr;  ///< nothing without shadow rays
  int light_count = 0;
  MonoAddress lights = 0;
  Sampler sampler = Sampler::philox;
  std::uint64_t seed = 0;
  std::int32_t next_pixel = 0;  ///< of the camera ray with number 0
  int pixel_stride = 1;
  std::int32_t next_sample = 0;
  std::int32_t remaining = 0;  ///< camera rays there still are, at most the number of PEs
  PolyPointer<PathRecord> next_path;
  PolyPointer<RayRecord> ray;
  PolyField<MonoAddress>
      light_place;  ///< of the light for the next vertex, kept for the intersection stage's gather
  LaneMask* live = nullptr;
};

/// Path stage: where the lanes that finished save to, packed by their ascending numbers.
struct FinishedPlaceArguments {
  PolyField<std::int32_t> number;
  MonoAddress next_finished = 0;
  PolyField<MonoAddress> finished_place;
};

/// What the control unit keeps in poly memory of each finished path while its vertices are added up.
struct FinishedPath {
  PolyField<MonoAddress> vertex_place;  ///< of its first vertex
  PolyField<MonoAddress> fold_place;
  PolyField<std::int32_t> vertices;
  PolyField<std::int32_t> pixel;  ///< -1 for a path that goes on
  PolyField<std::int32_t> sample;
};

/// Radiance stage, list step: where the vertices are, and which loads of kVerticesPerLoad each path needs.
struct ListArguments {
  PolyPointer<FinishedRecord> entry;
  MonoAddress vertices = 0;
  MonoAddress folds = 0;
  int slot_vertices = 0;
  FinishedPath path;
  LaneMask* needs_load = nullptr;  ///< slot_vertices / kVerticesPerLoad masks
  LaneMask* folded = nullptr;
  LaneMask* flushed = nullptr;
};

/// Radiance stage, fold step: adds kVerticesPerLoad vertices of each path, the last ones of the path first.
struct FoldArguments {
  FinishedPath path;
  PolyPointer<VertexRecord> vertices;
  int first_vertex = 0;
  bool starts = false;  ///< no vertices behind these
  /// Paths that were folded before; nothing when no path of the block was or goes on, so that no throughput
  /// is wanted.
  const LaneMask* folded = nullptr;
  PolyPointer<FoldRecord> earlier;       ///< those vertices
  PolyPointer<FoldRecord> sum;           ///< carried from step to step
  PolyPointer<RadianceRecord> radiance;  ///< written in the last step
  PolyPointer<FoldRecord> flushed;       ///< the same, for paths that go on
};

struct PacketKernels;

struct Kernels {
  cn::Kernel<IntersectArguments> intersect;
  cn::Kernel<ScatterArguments> scatter;
  cn::Kernel<IlluminateArguments> illuminate;
  cn::Kernel<AppendArguments> append;
  cn::Kernel<ReplaceArguments> replace;
  cn::Kernel<FinishedPlaceArguments> finished_place;
  cn::Kernel<ListArguments> list;
  cn::Kernel<FoldArguments> fold;
  const TraversalKernels& (*traversal)();  ///< of the same level, as the next
  const PacketKernels& (*packet)();
};

const Kernels& kernels(Level level);

/// The same, built to report their SRAM accesses to a cn::AccessObserver; for every x86-64 machine.
const Kernels& observed_kernels();

}  // namespace path_tracer
