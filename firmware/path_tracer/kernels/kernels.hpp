#pragma once

#include "firmware/cn/language/kernel.hpp"
#include "firmware/cn/simd/level.hpp"
#include "firmware/path_tracer/kernels/traversal_kernels.hpp"
#include "firmware/path_tracer/materials/lobe_use.hpp"
#include "firmware/path_tracer/prefilter/prefilter.hpp"
#include "firmware/path_tracer/prefilter/search_tree.hpp"
#include "firmware/path_tracer/program/program_config.hpp"
#include "firmware/path_tracer/records/tails.hpp"
#include "firmware/path_tracer/sampling/sampler.hpp"

/// The poly programs of the path tracer: their arguments and the table of entry points. Poly pointers point
/// to SRAM, plain pointers to mono memory that the control unit reads, `LaneMask*` to conditions that a
/// kernel leaves to the control unit.
namespace path_tracer {

/// Ray stage: the nearest triangle along each ray; triangles are tested one by one.
struct IntersectArguments {
  PolyPointer<RayRecord> ray;
  const TriangleRecord* triangles = nullptr;
  int triangle_count = 0;
  const Prefilter* prefilter = nullptr;  ///< the simulator's, of those triangles; nullptr to test each
  const SearchTree* tree = nullptr;      ///< the simulator's; of intersect_through_tree only
  double reach = 0;                      ///< of the scene (triangle_record.hpp)
  Layers layers;
  MonoRecords surfaces;
  bool hit_has_tail = false;  ///< ArrivalRecord
  PolyPointer<HitRecord> hit;
  PolyField<MonoAddress> surface_place;  ///< kept for the intersection stage's gather
  LaneMask* hit_something = nullptr;
};

/// Intersection stage, after the first loads, where a light is one of several candidates
/// (light_candidates.hpp).
struct LightCandidatesArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<SurfaceRecord> surface;
  PolyPointer<PathRecord> path;
  LightTable light_table;
  MonoAddress lights = 0;      ///< LightRecords
  MonoAddress candidates = 0;  ///< a LightCandidate for each
  Sampler sampler = Sampler::philox;
  std::uint64_t seed = 0;
  int count = 1;                          ///< of candidates
  PolyPointer<CandidateLookUp> look_ups;  ///< count of them
  PolyPointer<LightResampling> resampling;
  PolyField<MonoAddress> light_place;  ///< of the light that was taken
};

/// Intersection stage, segments: shading details, the new direction, and a shadow ray to the light that was
/// chosen before.
struct ScatterArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<SurfaceRecord> surface;
  PolyPointer<PathRecord> path;
  PolyPointer<LightRecord> light;
  bool resamples_lights = false;  ///< the light was one of several candidates
  PolyPointer<LightResampling> resampling;
  Sampler sampler = Sampler::philox;
  LightSampling light_sampling = LightSampling::area;
  std::uint64_t seed = 0;
  int roulette_start = 0;
  double max_survival = 0;
  bool casts_shadow_rays = false;  ///< if so, emission counts only where the camera sees it
  bool cull_shadow_rays = false;
  // Of layered scenes only: where the light was found, and the place of the first one.
  bool is_in_layers = false;
  PolyField<MonoAddress> light_place;
  MonoAddress lights = 0;
  PolyPointer<ScatterRecord> scatter;
  PolyPointer<RayRecord> shadow_ray;
  PolyPointer<LightingRecord> lighting;
  LaneMask* casts = nullptr;  ///< the slot's next ray is the shadow ray
};

/// Intersection stage, after the first loads: the texels that a texture shows at the hit.
struct LookUpArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<TextureRecord> texture;
  int footprint_bytes = 0;
  PolyPointer<TextureLookUp> look_up;
  LaneMask* needs = nullptr;  ///< PEs whose triangle has the texture
};

/// Intersection stage, after the first loads: the texel of the environment's image that a ray sees which hit
/// nothing.
struct EnvironmentLookUpArguments {
  PolyPointer<HitRecord> hit;
  EnvironmentImage image;
  PolyPointer<EnvironmentLookUp> look_up;
};

/// ScatterArguments for scenes that are not plain (records/features.hpp).
struct ShadeArguments : ScatterArguments {
  Features features;
  RecordSizes sizes{Features{}};
  Estimator estimator = Estimator::per_lobe;
  bool skips_absent_lobes = true;
  vec3<double> environment{};  ///< radiance from outside
  EnvironmentImage image;
  const SunRecord* suns = nullptr;
  int sun_count = 0;
  PolyPointer<TextureLookUp> look_ups;
  LaneMask* passes = nullptr;   ///< of scenes with coverage: PEs whose segment goes straight on
  LobeUse* lobe_use = nullptr;  ///< empty before the run
};

/// Intersection stage, shadow rays: direct light if the ray hit its light; the ray's rest if it hit a surface
/// that lets it through.
struct IlluminateArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<SurfaceRecord> surface;
  PolyPointer<LightingRecord> lighting;
  bool is_in_layers = false;
  Features features;
  RecordSizes sizes{Features{}};
  PolyPointer<TextureLookUp> look_ups;
  PolyPointer<DirectLightRecord> direct_light;
  // Of scenes with coverage only:
  Sampler sampler = Sampler::philox;
  std::uint64_t seed = 0;
  PolyPointer<RayRecord> shadow_ray;
  LaneMask* goes_on = nullptr;  ///< PEs whose shadow ray goes on from what it hit
};

/// Which pixels and samples camera rays belong to: pixel by pixel, then sample by sample.
struct CameraRayOrder {
  std::int32_t next_pixel = 0;  ///< of the camera ray with number 0, before the stride
  std::int32_t next_sample = 0;
  int pixel_stride = 1;
};

/// Path stage, first half: the vertex, and which paths end here.
struct AppendArguments {
  PolyPointer<PathRecord> path;
  PolyPointer<ScatterRecord> scatter;
  PolyPointer<DirectLightRecord> direct_light;
  const LaneMask* has_direct_light = nullptr;
  MonoAddress block_vertices = 0;  ///< vertices of the block's first slot
  int slot_vertices = 0;
  int first_slot = 0;
  PolyPointer<VertexRecord> vertex;
  PolyField<MonoAddress> vertex_place;
  PolyPointer<FinishedRecord> finished_record;
  LaneMask* ended = nullptr;
  LaneMask* finished = nullptr;  ///< the path ended or its slot is full
};

/// Path stage, before its second half, of a run with a list of camera samples: where the entries are.
struct ListedSampleArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the lanes whose path ended
  std::int32_t started = 0;        ///< paths to start, of the numbers from 0 on
  MonoAddress next_listed = 0;
  PolyField<MonoAddress> place;
  LaneMask* starts = nullptr;
};

/// Path stage, second half: the next segment of each path, and a camera ray (camera_rays.hpp) in the slot of
/// each path that ended.
struct ContinuePathsArguments {
  PolyPointer<PathRecord> path;
  PolyPointer<ScatterRecord> scatter;
  PolyField<std::int32_t> number;  ///< ascending numbers of the lanes whose path ended
  const LaneMask* ended = nullptr;
  const LaneMask* finished = nullptr;
  LightTable light_table;  ///< without a cdf if there are no shadow rays
  MonoAddress lights = 0;
  Sampler sampler = Sampler::philox;
  std::uint64_t seed = 0;
  const CameraRecord* camera = nullptr;
  CameraRayOrder camera_rays;
  bool is_listed = false;      ///< `next_path` names the pixel and sample already, not `camera_rays`
  std::int32_t remaining = 0;  ///< camera rays to generate for the numbers from 0 on
  PolyPointer<PathRecord> next_path;
  bool path_has_tail = false;  ///< DirectionRecord, as `path` and `scatter`
  bool has_passed = false;     ///< behind it a PassedRecord
  PolyPointer<RayRecord> ray;
  /// Place of the light for the next vertex, kept for the intersection stage's gather.
  PolyField<MonoAddress> light_place;
  LaneMask* live = nullptr;
};

/// Where records are saved, packed by ascending numbers: finished paths of the path stage, and binned hits.
struct NumberedPlaceArguments {
  PolyField<std::int32_t> number;
  MonoRecords records;  ///< from the one with number 0 on
  PolyField<MonoAddress> place;
};

/// Bins of hits: what a slot's ray hit.
struct BinHitArguments {
  PolyField<MonoAddress> surface_place;
  PolyField<MonoAddress> light_place;
  int first_slot = 0;
  const LaneMask* hit_something = nullptr;
  PolyPointer<BinnedHit> hit;
};

/// Bins of hits: where the records of a slot are.
struct LocateSlotArguments {
  static constexpr int kMaxPlaces = 4;
  PolyField<std::int32_t> slot;
  int places = 0;
  MonoRecords records[kMaxPlaces];
  PolyField<MonoAddress> place[kMaxPlaces];
};

/// Bins of hits: a condition as a record, which recall() reads.
struct FlagArguments {
  const LaneMask* lanes = nullptr;
  PolyField<MonoAddress> flag;
};

/// Kept in poly memory for each finished path while its vertices are added up.
struct FinishedPath {
  PolyField<MonoAddress> vertex_place;  ///< of its first vertex
  PolyField<MonoAddress> fold_place;
  PolyField<std::int32_t> vertices;
  PolyField<std::int32_t> pixel;  ///< -1 for a path that continues
  PolyField<std::int32_t> sample;
};

/// List stage: where the vertices are, and which loads of kVerticesPerLoad each path needs.
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

/// Fold stage: adds kVerticesPerLoad vertices of each path; a path's last vertices come first.
struct FoldArguments {
  FinishedPath path;
  PolyPointer<VertexRecord> vertices;
  int first_vertex = 0;
  bool starts = false;  ///< these are the last vertices of the paths
  /// Paths with vertices folded before. nullptr if no path of the block has such vertices or continues; then
  /// no throughput is needed.
  const LaneMask* folded = nullptr;
  PolyPointer<FoldRecord> earlier;       ///< the fold of those vertices
  PolyPointer<FoldRecord> sum;           ///< carried from step to step
  PolyPointer<RadianceRecord> radiance;  ///< written in the last step
  PolyPointer<FoldRecord> flushed;       ///< written in the last step, for paths that continue
};

struct PacketKernels;
struct LargePacketKernels;
struct RayStreamKernels;
struct StreamKernels;
struct ResidentKernels;
struct PairKernels;

struct Kernels {
  cn::Kernel<IntersectArguments> intersect;
  cn::Kernel<IntersectArguments> intersect_through_tree;  ///< the simulator's, where nothing is charged
  cn::Kernel<ScatterArguments> scatter;
  cn::Kernel<LookUpArguments> look_up;
  cn::Kernel<EnvironmentLookUpArguments> look_up_environment;
  cn::Kernel<LightCandidatesArguments> find_light_candidates;
  cn::Kernel<LightCandidatesArguments> resample_light;
  cn::Kernel<ShadeArguments> shade;
  cn::Kernel<IlluminateArguments> illuminate;
  cn::Kernel<AppendArguments> append;
  cn::Kernel<ListedSampleArguments> listed_sample;
  cn::Kernel<ContinuePathsArguments> continue_paths;
  cn::Kernel<NumberedPlaceArguments> finished_place;
  cn::Kernel<ListArguments> list;
  cn::Kernel<FoldArguments> fold;
  cn::Kernel<BinHitArguments> bin_hit;
  cn::Kernel<NumberedPlaceArguments> binned_hit_place;
  cn::Kernel<LocateSlotArguments> locate_slot;
  cn::Kernel<FlagArguments> flag;
  const TraversalKernels& (*traversal)();  ///< of the same level, as the others
  const PacketKernels& (*packet)();
  const LargePacketKernels& (*large_packet)();
  const RayStreamKernels& (*ray_stream)();
  const StreamKernels& (*stream)();
  const ResidentKernels& (*resident)();
  const PairKernels& (*pair)();  ///< of bidirectional paths
};

const Kernels& kernels(Level level);

/// Kernels built to report their SRAM accesses to a cn::AccessObserver; they run on every x86-64 machine of
/// this build.
const Kernels& observed_kernels();

}  // namespace path_tracer
