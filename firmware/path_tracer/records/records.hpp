#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/cn/language/vec3.hpp"

/// Records in mono memory. Poly buffers have the same layouts, so a transfer is a plain copy.
namespace path_tracer {

using cn::vec3;

inline constexpr std::int32_t kNoFace = -1;
inline constexpr std::int32_t kNoLight = -1;
/// Faces of lights without triangles; kNoFace of lights at a point.
inline constexpr std::int32_t kDistantFace = -2;
inline constexpr std::int32_t kEnvironmentFace = -3;

/// The camera turns a film position, x and y in pixels, into a ray. A pinhole camera's rays start at
/// `position` and run along direction + right * x + down * y. An orthographic camera's start at position +
/// right * x + down * y and run along `direction`, of unit length.
struct CameraRecord {
  vec3<double> position{};
  vec3<double> direction{};
  vec3<double> right{};
  vec3<double> down{};
  std::int32_t width = 0;
  std::int32_t height = 0;
  std::int32_t is_orthographic = 0;
  std::int32_t unused = 0;
};

/// A sample of a pixel, where a path begins: an entry of the list that the host may write (Work).
struct CameraSampleRecord {
  std::int32_t pixel = 0;
  std::int32_t sample = 0;
};

/// A triangle for intersection (triangle.hpp); made by triangle_record(). Triangles that share an edge or lie
/// on one another in one plane share a face. A ray that leaves a face ignores it, so no distance threshold is
/// needed to keep a surface from shadowing itself.
struct TriangleRecord {
  vec3<double> vertex{};
  vec3<double> edge1{};  ///< edges and `back` are scaled by one power of two, see triangle_record()
  vec3<double> edge2{};
  vec3<double> back{};  ///< edge2 x edge1, away from the front
  std::int32_t face = kNoFace;
  std::int32_t number = 0;  ///< in the scene; among hits at the same distance the lowest number wins
};

/// A triangle of a layered scene: one in which triangles lie on one another in one plane. Those of such a
/// plane have the plane in common to the last bit (layered_triangle_record.hpp): at a point of it they are
/// equally far along every ray.
struct LayeredTriangleRecord {
  TriangleRecord triangle{};  ///< its `back` is the plane's, scaled by a power of two, on the triangle's side
  double plane_offset = 0;    ///< back . (point of the plane - Layers::anchor)
  double area_ratio = 1;      ///< length of edge2 x edge1, scaled as the edges, over that of `back`; 1 to 2
};

/// What kernels know of the layers of a scene.
struct Layers {
  bool any = false;       ///< whether the scene is layered; then its triangles are LayeredTriangleRecords
  vec3<double> anchor{};  ///< a point of the scene that planes are measured from

  constexpr int record_bytes() const {
    return static_cast<int>(any ? sizeof(LayeredTriangleRecord) : sizeof(TriangleRecord));
  }
};

/// Returns the triangle of that index in an array whose records have so many bytes each.
inline const TriangleRecord& triangle_at(const TriangleRecord* first, int index, int record_bytes) {
  const char* const bytes = reinterpret_cast<const char*>(first);
  return *reinterpret_cast<const TriangleRecord*>(bytes + std::ptrdiff_t{index} * record_bytes);
}
/// The whole record of a triangle of a layered scene.
inline const LayeredTriangleRecord& layered(const TriangleRecord& triangle) {
  static_assert(offsetof(LayeredTriangleRecord, triangle) == 0);
  return reinterpret_cast<const LayeredTriangleRecord&>(triangle);
}

/// A triangle for shading: "around 10 double precision floats" (paper, section 4.1).
struct SurfaceRecord {
  vec3<double> normal{};  ///< unit length, towards the front
  vec3<double> reflectance{};
  vec3<double> emission{};
  std::int32_t face = kNoFace;
  std::int32_t light = kNoLight;  ///< number of the light that the triangle belongs to
};

enum class LightShape : std::int32_t {
  triangle,     ///< of edge1 and edge2
  rectangle,    ///< the parallelogram of edge1 and edge2, which are orthogonal
  point,        ///< light from a point, all around or in a cone
  distant,      ///< light from infinitely far away: parallel, or from a disk in the sky
  environment,  ///< a part of the environment's image
};

/// A light: a triangle or rectangle that emits from its front, where edge1 x edge2 points. Lights of other
/// shapes keep in the same fields what light_shapes.hpp says.
struct LightRecord {
  vec3<double> vertex{};
  vec3<double> edge1{};
  vec3<double> edge2{};
  vec3<double> normal{};
  double inverse_pdf = 0;       ///< area / probability of this light
  std::int32_t face = kNoFace;  ///< or kDistantFace or kEnvironmentFace
  std::int32_t shape = static_cast<std::int32_t>(LightShape::triangle);
};

/// Lights that are chosen equally often, where there are many; they stand side by side.
struct LightClass {
  std::int32_t first = 0;
  std::int32_t count = 0;
};

/// A light as a candidate of the light that a vertex samples (kernels/light_candidates.hpp): what it takes to
/// estimate the light's effect.
struct LightCandidate {
  vec3<float> centre{};  ///< of a light far away: a point in its direction, far outside the scene
  vec3<float> axis{};    ///< where it shines to, unit length; 0 if it shines all around
  float radius = 0;      ///< around the centre
  float weight = 0;      ///< radiant intensity along the axis over the probability of the light
};

/// In SRAM: a candidate, and what is left of the random number that chose it.
struct CandidateLookUp {
  std::uint64_t place = 0;  ///< mono address of the LightCandidate
  double rest = 0;          ///< uniform in [0, 1)
  LightCandidate candidate{};
};

/// In SRAM: how one of the candidates is taken.
struct LightResampling {
  double choice = 0;  ///< random number
  double factor = 1;  ///< of the contribution of the light that was taken
};

/// Record of the ray bin. With direct lighting, a slot's ray is the next segment of its path or the shadow
/// ray of the last segment.
struct RayRecord {
  vec3<double> origin{};
  vec3<double> direction{};
  std::int32_t left_face = kNoFace;   ///< the face that the ray leaves
  std::int32_t light_face = kNoFace;  ///< a shadow ray's: the face of its light
};

/// Record of the ray queue, where rays stand packed, whatever slot they belong to.
struct QueuedRay {
  RayRecord ray{};
  std::int32_t slot = 0;
  std::int32_t light = 0;  ///< a shadow ray's: the number of its light
};

/// Record of the intersection bin.
struct HitRecord {
  vec3<double> position{};
  std::int32_t hit = 0;    ///< 1 if the ray hit a triangle
  std::int32_t front = 0;  ///< 1 if it hit the front
};

/// From the intersection stage to the path stage: the vertex and the next segment.
struct ScatterRecord {
  vec3<double> position{};
  vec3<double> direction{};
  vec3<double> radiance{};  ///< from the vertex towards the path's start, without direct light
  vec3<double> weight{};    ///< factor for the radiance from the rest of the path
  std::int32_t face = kNoFace;
  std::int32_t ended = 0;
};

/// Kept while a shadow ray is under way: what its light contributes.
struct LightingRecord {
  vec3<double> weight{};  ///< factor for the radiance of the light's face, or of what stands for it
  std::int32_t light_face = kNoFace;  ///< what the shadow ray must hit: LightRecord::face
  std::int32_t light = kNoLight;      ///< number of the light: what it must hit in a layered scene
};

/// From the intersection stage to the path stage: the direct light that a shadow ray found.
struct DirectLightRecord {
  vec3<double> radiance{};
};

/// Record of the path bin: the path in a slot, and how far it is. It begins as a CameraSampleRecord does.
struct PathRecord {
  std::int32_t pixel = 0;
  std::int32_t sample = 0;
  std::int32_t depth = 0;     ///< segments traced so far
  std::int32_t vertices = 0;  ///< in the slot
  std::int32_t folded = 0;    ///< 1 when earlier vertices were folded into a FoldRecord
  std::int32_t unused = 0;
  double light_u = 0;  ///< point on the light for the shadow ray of the next vertex
  double light_v = 0;
};
static_assert(offsetof(PathRecord, pixel) == offsetof(CameraSampleRecord, pixel) &&
              offsetof(PathRecord, sample) == offsetof(CameraSampleRecord, sample));

/// Vertex of a path; slot_vertices of them for each slot.
struct VertexRecord {
  vec3<double> radiance{};
  vec3<double> weight{};
};

/// The folded vertices of a path that did not fit its slot.
struct FoldRecord {
  vec3<double> radiance{};
  vec3<double> throughput{};
};

/// A path whose vertices wait for their radiance, because the path ended or its slot is full.
struct FinishedRecord {
  std::int32_t slot = 0;
  std::int32_t vertices = 0;
  std::int32_t pixel = 0;
  std::int32_t sample = 0;
  std::int32_t folded = 0;
  std::int32_t ended = 0;
};

/// The result of a path, for the host. A pixel of -1 marks no result.
struct RadianceRecord {
  vec3<double> radiance{};
  std::int32_t pixel = -1;
  std::int32_t sample = 0;
};

/// Header of a half of the results, written before the firmware signals that the half is ready.
struct ResultsHeader {
  std::int32_t records = 0;
  std::int32_t unused = 0;
};

}  // namespace path_tracer
