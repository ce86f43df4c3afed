#pragma once

#include "firmware/path_tracer/records/features.hpp"
#include "firmware/path_tracer/records/records.hpp"

/// Records of bidirectional paths in mono memory and in poly buffers.
namespace path_tracer {

/// RadianceRecord::sample of light that a light path brings to a pixel, beside the pixel's samples.
inline constexpr std::int32_t kSplatSample = -1;

/// What a slot's ray is, or does next.
enum class PairRay : std::int32_t {
  light_start,  ///< the first segment of a light path
  light_segment,
  lens,       ///< from a vertex of the light path to the lens
  eye_start,  ///< the camera ray
  eye_segment,
  light_sample,  ///< from a vertex of the eye path to a point of a light
  light_vertex,  ///< from a vertex of the eye path to one of the light path
};

/// Record of the path bin: the pair of paths in a slot, and how far it is. It begins as a CameraSampleRecord
/// does. The names of densities and sums are those of weights.hpp. A window of light_vertices doubles, the
/// eye path's sums over other strategies, follows. What segments alone need comes last, so that the rays of
/// connections, which are most, load and save no more than the first bytes.
struct PairRecord {
  std::int32_t pixel = 0;
  std::int32_t sample = 0;
  std::int32_t ray = 0;                  ///< a PairRay
  std::int32_t depth = 0;                ///< segments of the path under way
  std::int32_t light_vertices = 0;       ///< in the slot
  std::uint32_t connections = 0;         ///< of the newest vertex, still to be tested; a bit each
  std::int32_t goes_on = 0;              ///< 1: the path under way has another segment
  std::int32_t face = kNoFace;           ///< that the next segment leaves
  std::int32_t target_face = kNoFace;    ///< what the ray of a connection must hit
  std::int32_t target_light = kNoLight;  ///< the same in layered scenes
  std::int32_t target = 0;               ///< of a connection: the light path's vertex; to the lens: the pixel
  std::int32_t is_parallel = 0;  ///< 1: the next segment is one of parallel light, or of an orthographic lens
  double light_u = 0;            ///< a point of the light that is sampled
  double light_v = 0;
  vec3<double> radiance{};      ///< of the eye path so far
  vec3<double> contribution{};  ///< of the connection, if nothing is in between
  // Of segments:
  vec3<double> position{};      ///< where the next segment starts
  vec3<double> direction{};     ///< of unit length
  vec3<double> throughput{};    ///< of the next segment
  vec3<double> absorption{};    ///< of a light path's next segment, per unit of length
  double pdf = 0;               ///< of the next segment's direction
  double reverse_pdf = 0;       ///< of the opposite direction at the newest vertex
  double inverse_pdf = 0;       ///< of the newest vertex
  double distance_squared = 1;  ///< to the one before
  double connects_before = 0;   ///< of the vertex before the newest one
  double connects = 0;          ///< of the newest vertex
  double light_sum = 0;         ///< of a light path, before the newest vertex
};
static_assert(offsetof(PairRecord, pixel) == offsetof(CameraSampleRecord, pixel) &&
              offsetof(PairRecord, sample) == offsetof(CameraSampleRecord, sample));

/// A vertex of either path. Scenes with shading normals have a VertexNormalRecord behind it, scenes that are
/// not only diffuse a VertexMaterialRecord behind that.
struct PathVertexRecord {
  vec3<double> position{};
  vec3<double> normal{};  ///< of the triangle, on its front
  vec3<double> to_previous{};
  vec3<double> throughput{};  ///< of the segment that arrived
  vec3<double> base_color{};
  double inverse_pdf = 0;
  double distance_squared = 1;
  double connects_before = 0;
  double light_sum = 0;
  std::int32_t face = kNoFace;
  std::int32_t unused = 0;
};
struct VertexNormalRecord {
  vec3<double> normal{};  ///< of shading, on the triangle's front
};
/// A Material (materials/material.hpp) as seen from the front.
struct VertexMaterialRecord {
  double metallic = 0;
  double roughness = 1;
  double f0 = 0;
  double f90 = 0;
  double transmission = 0;
  double ior = 1;
  double thin = 0;  ///< 1 or 0
  double coat = 0;
  double coat_roughness = 0;
  double sheen_roughness = 0;
  vec3<double> sheen_color{};
  vec3<double> varnish_tint{};
  vec3<double> transmission_color{};
  vec3<double> absorption{};
};

/// What it takes to see whether a vertex of the light path may be joined with one of the eye path.
struct LightHeadRecord {
  vec3<double> position{};
  vec3<double> normal{};   ///< of the triangle, on the side that the light came from
  std::int32_t sides = 0;  ///< that scatter light: 0 for mirrors and clear glass, 1, or 2 if some passes
  std::int32_t unused = 0;
};

/// Behind a PairRecord and its window, in scenes with coverage: a ray that a surface has let through.
struct PassingRecord {
  vec3<double> origin{};        ///< of what is left of a connection
  vec3<double> direction{};     ///< likewise, up to its end if that is near
  double distance = 0;          ///< that a segment has behind it
  std::int32_t face = kNoFace;  ///< that the ray goes through
  std::int32_t passes = 0;      ///< 1: the ray goes on, and its slot does nothing else
};

/// Bytes of a PairRecord that every ray needs in scenes without coverage.
inline constexpr int kPairBytesOfConnections = int{offsetof(PairRecord, position)};

/// What a light emits: radiance of a light with triangles, which LightRecord does not have.
struct LightEmissionRecord {
  vec3<double> radiance{};
};

/// Sizes of the records above in a scene, and the places of their parts.
struct PairSizes {
  int pair = sizeof(PairRecord);
  int pair_of_connection = kPairBytesOfConnections;  ///< as much of `pair` as the ray of a connection needs
  int vertex = sizeof(PathVertexRecord);
  int heads = 0;  ///< of a slot
  int window = sizeof(PairRecord);
  int normal = 0;    ///< 0: the scene has none of it
  int material = 0;  ///< likewise
  int passing = 0;   ///< likewise; in a PairRecord

  PairSizes(const Features& features, int light_vertices)
      : pair(int{sizeof(PairRecord)} + light_vertices * int{sizeof(double)}),
        heads(light_vertices * int{sizeof(LightHeadRecord)}) {
    if (features.coverage) {
      passing = pair;
      pair += int{sizeof(PassingRecord)};
      pair_of_connection = pair;
    }
    if (features.shading_normals()) {
      normal = vertex;
      vertex += int{sizeof(VertexNormalRecord)};
    }
    if (features.lobes.only_diffuse()) return;
    material = vertex;
    vertex += int{sizeof(VertexMaterialRecord)};
  }
};

}  // namespace path_tracer
