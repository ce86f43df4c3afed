#include <algorithm>
#include <cmath>

#include "testbench/bvh/bvh.hpp"
#include "testbench/mono_image/emitter.hpp"

namespace testbench {
namespace {

using path_tracer::LightShape;

glm::dvec3 from_record(const cn::vec3<double>& v) {
  return {v.x, v.y, v.z};
}

double sum_of_channels(const glm::dvec3& colour) {
  return colour.x + colour.y + colour.z;
}

Sighting sight_surface(const Emitter& emitter, const glm::dvec3& position, const glm::dvec3& normal,
                       glm::dvec2 place) {
  if (emitter.shape() == LightShape::triangle && place.x + place.y > 1.0) place = 1.0 - place;
  const glm::dvec3 point = from_record(emitter.record.vertex) + place.x * from_record(emitter.record.edge1) +
                           place.y * from_record(emitter.record.edge2);
  Sighting sighting;
  sighting.to_light = point - position;
  const double distance_squared = glm::dot(sighting.to_light, sighting.to_light);
  const double cosine_here = glm::dot(sighting.to_light, normal);
  const double cosine_there = -glm::dot(sighting.to_light, from_record(emitter.record.normal));
  if (!(cosine_here > 0.0 && cosine_there > 0.0)) return sighting;
  const double cosines = cosine_here * cosine_there / distance_squared;
  sighting.irradiance =
      sum_of_channels(emitter.emission) * emitter.measure * cosines / (distance_squared + emitter.measure);
  return sighting;
}

Sighting sight_point(const Emitter& emitter, const glm::dvec3& position, const glm::dvec3& normal,
                     double radius) {
  constexpr double kNearest = 1e-3;  // of the scene's radius
  Sighting sighting;
  sighting.to_light = from_record(emitter.record.vertex) - position;
  const double distance = glm::length(sighting.to_light);
  const double cosine = glm::dot(sighting.to_light, normal) / distance;
  if (!(cosine > 0.0)) return sighting;
  const double cosine_of_axis = -glm::dot(sighting.to_light, from_record(emitter.record.normal)) / distance;
  const double inside =
      std::clamp(cosine_of_axis * emitter.record.edge2.x + emitter.record.edge2.y, 0.0, 1.0);
  const double bounded = std::max(distance, kNearest * radius);
  sighting.irradiance = sum_of_channels(emitter.emission) * inside * inside * cosine / (bounded * bounded);
  return sighting;
}

/// @param direction towards the light, unit length
Sighting sight_far(const Emitter& emitter, const glm::dvec3& direction, const glm::dvec3& normal,
                   double radius) {
  constexpr double kOutside = 4.0;  // in radii of the scene, from any surface
  Sighting sighting;
  sighting.to_light = kOutside * radius * direction;
  sighting.irradiance =
      std::max(sum_of_channels(emitter.emission) * emitter.measure * glm::dot(direction, normal), 0.0);
  return sighting;
}

glm::dvec3 direction_to_cell(const path_tracer::LightRecord& cell, const glm::dvec2& place) {
  const double longitude = cell.edge1.x + place.x * cell.edge1.y;
  const double up = cell.edge2.x + place.y * cell.edge2.y;
  const double across = std::sqrt(std::max(1.0 - up * up, 0.0));
  return {across * std::sin(longitude), up, -across * std::cos(longitude)};
}

}  // namespace

Surroundings surroundings_of(const Scene& scene) {
  Box box;
  for (const Triangle& triangle : scene.triangles) box.include(bounds_of(triangle));
  return {0.5 * glm::length(box.upper - box.lower), scene.environment.rotation};
}

Sighting sight(const Emitter& emitter, const glm::dvec3& position, const glm::dvec3& normal,
               const glm::dvec2& place, const Surroundings& surroundings) {
  switch (emitter.shape()) {
    case LightShape::triangle:
    case LightShape::rectangle:
      return sight_surface(emitter, position, normal, place);
    case LightShape::point:
      return sight_point(emitter, position, normal, surroundings.radius);
    case LightShape::distant:
      return sight_far(emitter, emitter.centre, normal, surroundings.radius);
    case LightShape::environment:
      break;
  }
  return sight_far(emitter, surroundings.rotation * direction_to_cell(emitter.record, place), normal,
                   surroundings.radius);
}

}  // namespace testbench
