#pragma once

#include "firmware/path_tracer/kernels/kernels.hpp"

/// The poly programs of paths that stay in the PEs' SRAM (resident/resident_tracer.hpp), where the scene is
/// as well.
namespace path_tracer {

/// In SRAM: a ray, and the nearest hit of its search.
struct ResidentRay {
  vec3<double> origin{};
  vec3<double> direction{};
  double distance = 0;      ///< along the direction * |determinant|
  double determinant = 1;   ///< positive where the ray met the front
  std::int32_t number = 0;  ///< of the triangle; negative without a hit
  std::int32_t left_face = kNoFace;
};

/// In SRAM: a path. Its radiance is summed from its start. While its next segment is searched for, so is the
/// shadow ray of its last vertex. A path that ended gives its place to the next one at once; what it has
/// gathered waits until its last shadow ray is over.
struct ResidentPath {
  ResidentRay segment{};
  ResidentRay shadow{};
  vec3<double> throughput{};
  vec3<double> radiance{};
  vec3<double> lighting{};  ///< times the emission of the shadow ray's light: radiance that it brings
  vec3<double> ended_radiance{};
  std::int32_t pixel = 0;
  std::int32_t sample = 0;
  std::int32_t ended_pixel = 0;
  std::int32_t ended_sample = 0;
  std::int32_t depth = 0;  ///< segments traced so far
  std::int32_t light_face = kNoFace;
};

/// Vectors of four that the search keeps in SRAM, because a PE's registers hold four: see RayVectors.
inline constexpr int kSearchVectors = 6;

/// Conditions on the paths of each PE, which the control unit keeps.
using PathMasks = std::array<LaneMask, kMaxResidentPaths>;

/// Searches for the nearest hit of a ray of each path.
struct ResidentSearchArguments {
  PolyPointer<ResidentRay> rays;  ///< of the first path; the others lie sizeof(ResidentPath) apart
  cn::PolySpan vectors;           ///< kSearchVectors of them; of the search by vectors only
  const PathMasks* wanted = nullptr;
  const TriangleRecord* triangles = nullptr;
  int triangle_count = 0;
  double reach = 0;  ///< of the scene (triangle_record.hpp)
};

/// Adds the light that shadow rays bring, lists the paths that ended before, and continues paths at what
/// their segments hit.
struct ResidentShadeArguments {
  PolyPointer<ResidentPath> paths;
  int path_count = 0;
  PolyPointer<SurfaceRecord> surfaces;  ///< of the whole scene
  PolyPointer<LightRecord> lights;
  LightTable light_table;
  bool casts_shadow_rays = false;
  bool cull_shadow_rays = false;
  Sampler sampler = Sampler::philox;
  LightSampling light_sampling = LightSampling::area;
  std::uint64_t seed = 0;
  int roulette_start = 0;
  double max_survival = 1;
  PolyPointer<RadianceRecord> results;  ///< kResidentResults of them
  PolyField<std::int32_t> result_count;
  const PathMasks* live = nullptr;  ///< paths with a segment
  PathMasks* casts = nullptr;       ///< paths with a shadow ray, before and after
  PathMasks* ended = nullptr;       ///< paths that wait for their shadow ray, before and after
  PathMasks* reflecting = nullptr;  ///< vertices that want light; for counts only
  LaneMask* nearly_full = nullptr;  ///< PEs whose results the next call may overflow
};

/// Begins a path in each place of a path that ended, while camera rays are left.
struct ResidentStartArguments {
  PolyPointer<ResidentPath> paths;
  int path_count = 0;
  const PathMasks* ended = nullptr;
  PolyField<std::int32_t> number;  ///< of the PE's first camera ray, from next_pixel and next_sample on
  std::int32_t remaining = 0;
  const CameraRecord* camera = nullptr;
  CameraRayOrder camera_rays;
  Sampler sampler = Sampler::philox;
  std::uint64_t seed = 0;
  PathMasks* started = nullptr;
};

/// Marks all places for results as empty.
struct ClearResultsArguments {
  PolyPointer<RadianceRecord> results;
  PolyField<std::int32_t> result_count;
};

struct ResidentKernels {
  cn::Kernel<ResidentSearchArguments> search;
  cn::Kernel<ResidentSearchArguments> search_by_vectors;
  cn::Kernel<ResidentShadeArguments> shade;
  cn::Kernel<ResidentStartArguments> start;
  cn::Kernel<ClearResultsArguments> clear_results;
};

}  // namespace path_tracer
