#pragma once

#include "firmware/path_tracer/bidirectional/lens.hpp"
#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/records/pair_records.hpp"

/// The poly programs of bidirectional paths: their arguments and the table of entry points.
namespace path_tracer {

/// What kernels know of the lens, the film and the sky.
struct PairWorld {
  Lens lens;
  vec3<double> centre{};  ///< of a sphere around the scene, through which light from far away comes
  double radius = 0;
  int light_vertices = 1;  ///< that a slot keeps, at most
  bool has_lights = false;
  bool has_silent_lights = false;  ///< lights from which no light path begins
};

/// Vertex stage, segments: the vertex that the segment has found, and the next segment.
/// `path` and `scatter` are not used, nor what belongs to shadow rays.
struct ReachArguments : ShadeArguments {
  PairWorld world;
  PairSizes pair_sizes{Features{}, 1};
  const double* sun_pdfs = nullptr;  ///< by which connections find the suns
  PolyPointer<PairRecord> pair;      ///< changed in place
  PolyPointer<LightHeadRecord> heads;
  PolyPointer<PathVertexRecord> vertex;
  PolyPointer<LightHeadRecord> head;
  MonoAddress block_vertices = 0;  ///< of the block's first slot
  MonoAddress block_heads = 0;
  PolyField<MonoAddress> vertex_place;
  PolyField<MonoAddress> head_place;
  LaneMask* is_vertex = nullptr;        ///< has a vertex to save
  LaneMask* is_light_vertex = nullptr;  ///< and its head
};

/// Vertex stage, connections: what they bring if nothing is in between.
struct SeeArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<SurfaceRecord> surface;
  PolyPointer<TextureLookUp> look_ups;
  Features features;
  RecordSizes sizes{Features{}};
  bool is_in_layers = false;
  Sampler sampler = Sampler::philox;
  std::uint64_t seed = 0;
  PairSizes pair_sizes{Features{}, 1};
  PolyPointer<PairRecord> pair;  ///< changed in place
  PolyPointer<RadianceRecord> result;
  LaneMask* is_result = nullptr;  ///< reached the lens
};

/// Vertex stage, at its end: what each slot does next.
struct DecideArguments {
  PairSizes pair_sizes{Features{}, 1};
  PolyPointer<PairRecord> pair;  ///< changed in place
  int light_vertices = 1;
  PolyPointer<RadianceRecord> result;
  LaneMask* ended = nullptr;  ///< the pair is complete, and `result` has its radiance
};

/// Vertex stage, slots whose pair ended: the next pair.
struct BeginPairArguments {
  PolyField<std::int32_t> number;  ///< ascending numbers of the slots
  std::int32_t remaining = 0;      ///< pairs to begin, at most the number of PEs
  const CameraRecord* camera = nullptr;
  CameraRayOrder order;
  bool is_listed = false;  ///< `pair` names pixel and sample already
  bool has_lights = false;
  PolyPointer<PairRecord> pair;
  LaneMask* begins = nullptr;
};

/// Vertex stage: what the next ray needs besides its slot's records.
struct LocateFarArguments {
  PairSizes pair_sizes{Features{}, 1};
  bool has_silent_lights = false;
  PolyPointer<PairRecord> pair;  ///< gets the point of the light
  LightTable light_table;
  MonoAddress lights = 0;
  MonoAddress light_emission = 0;
  MonoAddress block_vertices = 0;
  int vertex_bytes = 0;
  int light_vertices = 1;
  Sampler sampler = Sampler::philox;
  std::uint64_t seed = 0;
  PolyField<MonoAddress> light_place;
  PolyField<MonoAddress> emission_place;
  PolyField<MonoAddress> near_place;
  PolyField<MonoAddress> far_place;
  LaneMask* needs_light = nullptr;
  LaneMask* needs_emission = nullptr;
  LaneMask* needs_near = nullptr;
  LaneMask* needs_far = nullptr;
  LaneMask* needs_segment = nullptr;  ///< what connections do not need of a PairRecord
  LaneMask* starts = nullptr;         ///< a path
};

/// Connection stage: the ray of each slot.
struct ConnectArguments {
  PairWorld world;
  PairSizes pair_sizes{Features{}, 1};
  Features features;
  bool skips_absent_lobes = true;
  const CameraRecord* camera = nullptr;
  EnvironmentImage image;
  Sampler sampler = Sampler::philox;
  LightSampling light_sampling = LightSampling::area;
  std::uint64_t seed = 0;
  bool is_in_layers = false;
  MonoAddress lights = 0;
  PolyField<MonoAddress> light_place;
  PolyPointer<PairRecord> pair;  ///< changed in place
  PolyPointer<LightRecord> light;
  PolyPointer<LightEmissionRecord> emission;
  PolyPointer<PathVertexRecord> near_vertex;
  PolyPointer<PathVertexRecord> far_vertex;
  PolyPointer<RayRecord> ray;
  LaneMask* connects = nullptr;   ///< the ray is that of a connection
  LaneMask* to_lens = nullptr;    ///< to the lens
  LaneMask* to_vertex = nullptr;  ///< to a vertex of the light path
  LaneMask* of_light = nullptr;   ///< a segment of a light path
  LaneMask* is_culled = nullptr;  ///< left out a connection that brings nothing
};

/// Copies a record word by word.
struct CopyPairArguments {
  int from_offset = 0;
  int to_offset = 0;
  int bytes = 0;
};

/// Vertex stage, after the first loads: the texel of the environment's image that a ray sees which hit
/// nothing, or from which a light path comes.
struct SkyLookUpArguments {
  PolyPointer<HitRecord> hit;
  PolyPointer<PairRecord> pair;
  EnvironmentImage image;
  PolyPointer<EnvironmentLookUp> look_up;
  LaneMask* needs = nullptr;
};

struct PairKernels {
  cn::Kernel<ReachArguments> reach;
  cn::Kernel<SeeArguments> see;
  cn::Kernel<DecideArguments> decide;
  cn::Kernel<BeginPairArguments> begin_pair;
  cn::Kernel<LocateFarArguments> locate_far;
  cn::Kernel<ConnectArguments> connect;
  cn::Kernel<CopyPairArguments> copy_pair;
  cn::Kernel<SkyLookUpArguments> look_up_sky;
};

}  // namespace path_tracer
