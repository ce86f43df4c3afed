#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "firmware/path_tracer/program/program_config.hpp"
#include "firmware/path_tracer/records/records.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// What is sampled as one light, before it is decided how often.
struct Emitter {
  path_tracer::LightRecord record;  ///< all but inverse_pdf
  double measure = 1.0;        ///< what positions on it are uniform in: area, solid angle, or 1 for a point
  glm::dvec3 emission{0.0};    ///< mean radiance, or what stands for it in `record`; linear RGB
  double power = 0.0;          ///< sum of channels, up to a factor that all lights have in common
  glm::dvec3 centre{0.0};      ///< of its positions, or the direction towards it if it is far away
  std::int32_t material = -1;  ///< of its triangles
  std::vector<std::size_t> triangles;  ///< of the scene

  path_tracer::LightShape shape() const { return path_tracer::LightShape(record.shape); }
};

/// The scene's emitting triangles; by solid angle, two that follow each other and form a rectangle are one
/// emitter. Triangles that do not emit are left out.
/// @param faces of the scene's triangles
std::vector<Emitter> surface_emitters(const Scene& scene, const std::vector<std::int32_t>& faces,
                                      path_tracer::LightSampling sampling);

/// The scene's lights without area, without those that are dark.
/// @param radius Surroundings::radius, for the power of those far away
std::vector<Emitter> light_emitters(const Scene& scene, double radius);

/// Where light from far away comes from.
struct Surroundings {
  double radius = 0.0;       ///< half the diagonal of the box around the scene's triangles
  glm::dmat3 rotation{1.0};  ///< Environment::rotation
};
Surroundings surroundings_of(const Scene& scene);

/// A point of an emitter, as seen from a surface.
struct Sighting {
  glm::dvec3 to_light{
      0.0};  ///< from the surface to the point; to a point outside the scene if it is far away
  /// What it sends to the surface if nothing is in between: irradiance, sum of channels. Near an emitter it
  /// is bounded, as the whole emitter's is.
  double irradiance = 0.0;
};

/// @param normal of the surface, unit length
/// @param place uniform in the unit square
Sighting sight(const Emitter& emitter, const glm::dvec3& position, const glm::dvec3& normal,
               const glm::dvec2& place, const Surroundings& surroundings);

}  // namespace testbench
