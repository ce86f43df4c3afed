#include <cmath>
#include <glm/gtc/constants.hpp>

#include "testbench/mono_image/emitter.hpp"
#include "testbench/mono_image/to_record.hpp"

namespace testbench {
namespace {

using path_tracer::LightShape;

double channels_of(const glm::dvec3& colour) {
  return colour.x + colour.y + colour.z;
}

/// Power over pi, as that of surfaces: 4 times the intensity, by the share of directions that are lit.
Emitter near_emitter(const Light& light) {
  Emitter emitter;
  emitter.record.vertex = to_record(light.position);
  emitter.record.edge1 = to_record(light.intensity);
  emitter.record.edge2 = {0.0, 1.0, 0.0};
  emitter.record.normal = to_record(light.direction);
  emitter.record.shape = static_cast<std::int32_t>(LightShape::point);
  emitter.emission = light.intensity;
  emitter.centre = light.position;
  double lit_share = 1.0;
  if (light.kind == LightKind::spot) {
    const double inner = std::cos(light.inner_cone_radians);
    const double outer = std::cos(light.outer_cone_radians);
    emitter.record.edge2 = {1.0 / (inner - outer), -outer / (inner - outer), 0.0};
    lit_share = 0.5 * (1.0 - 0.5 * (inner + outer));
  }
  emitter.power = 4.0 * lit_share * channels_of(light.intensity);
  return emitter;
}

double half_angle(const Light& light) {
  return light.kind == LightKind::sun ? 0.5 * light.angular_diameter_radians : 0.0;
}

/// A disk of half angle a and radiance L gives a surface that faces it the irradiance pi sin^2(a) L; its
/// solid angle is 2 pi (1 - cos(a)). So directions uniform in it stand for 2 / (1 + cos(a)) of the
/// irradiance.
Emitter distant_emitter(const Light& light, double radius) {
  const double angle = half_angle(light);
  const double sine_of_half = std::sin(0.5 * angle);
  Emitter emitter;
  emitter.emission = light.intensity * (2.0 / (1.0 + std::cos(angle)));
  emitter.record.edge1 = to_record(emitter.emission);
  emitter.record.edge2 = {2.0 * sine_of_half * sine_of_half, 0.0, 0.0};
  emitter.record.normal = to_record(-light.direction);
  emitter.record.face = path_tracer::kDistantFace;
  emitter.record.shape = static_cast<std::int32_t>(LightShape::distant);
  emitter.power = radius * radius * channels_of(light.intensity);
  emitter.centre = -light.direction;
  return emitter;
}

}  // namespace

std::vector<Emitter> light_emitters(const Scene& scene, double radius) {
  std::vector<Emitter> emitters;
  for (const Light& light : scene.lights) {
    const bool is_near = light.kind == LightKind::point || light.kind == LightKind::spot;
    Emitter emitter = is_near ? near_emitter(light) : distant_emitter(light, radius);
    if (emitter.power > 0.0) emitters.push_back(std::move(emitter));
  }
  return emitters;
}

}  // namespace testbench
