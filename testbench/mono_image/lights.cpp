#include "testbench/mono_image/lights.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "testbench/mono_image/mean_emission.hpp"
#include "testbench/mono_image/to_record.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using path_tracer::LightRecord;
using path_tracer::LightShape;

/// Part of the scene that is sampled as one light.
struct Emitter {
  glm::dvec3 vertex;
  glm::dvec3 edge1;
  glm::dvec3 edge2;
  LightShape shape;
  glm::dvec3 emission;  ///< mean radiance, estimated
  std::int32_t material;
  std::int32_t face;
  std::vector<std::size_t> triangles;
};

double area(const Emitter& emitter) {
  const double parallelogram = glm::length(glm::cross(emitter.edge1, emitter.edge2));
  return emitter.shape == LightShape::triangle ? 0.5 * parallelogram : parallelogram;
}

/// The radiant power of a light, up to a common factor. Lights are chosen in proportion to it.
double power(const Emitter& emitter) {
  const glm::dvec3& emission = emitter.emission;
  return area(emitter) * (emission.x + emission.y + emission.z);
}

/// The rectangle that two triangles of one face and material form; std::nullopt if they form none. The
/// tolerance for rounding is 2^-40.
std::optional<Emitter> join(const Emitter& a, const Emitter& b) {
  constexpr double kTolerance = 0x1p-40;
  if (a.face != b.face || a.material != b.material) return {};
  const glm::dvec3 corners_a[3] = {a.vertex, a.vertex + a.edge1, a.vertex + a.edge2};
  const glm::dvec3 corners_b[3] = {b.vertex, b.vertex + b.edge1, b.vertex + b.edge2};
  for (int i = 0; i < 3; ++i) {
    // The right angle lies at a corner of `a`, the opposite corner is one of `b`.
    Emitter joined = a;
    joined.emission = 0.5 * (a.emission + b.emission);
    joined.vertex = corners_a[i];
    joined.edge1 = corners_a[(i + 1) % 3] - joined.vertex;
    joined.edge2 = corners_a[(i + 2) % 3] - joined.vertex;
    joined.shape = LightShape::rectangle;
    const double size = glm::length(joined.edge1) * glm::length(joined.edge2);
    if (std::abs(glm::dot(joined.edge1, joined.edge2)) > kTolerance * size) continue;
    const auto is_corner_of_b = [&](const glm::dvec3& point) {
      return std::any_of(std::begin(corners_b), std::end(corners_b), [&](const glm::dvec3& corner) {
        return glm::length(corner - point) <= kTolerance * std::sqrt(size);
      });
    };
    if (is_corner_of_b(joined.vertex + joined.edge1) && is_corner_of_b(joined.vertex + joined.edge2) &&
        is_corner_of_b(joined.vertex + joined.edge1 + joined.edge2)) {
      joined.triangles.insert(joined.triangles.end(), b.triangles.begin(), b.triangles.end());
      return joined;
    }
  }
  return {};
}

std::vector<Emitter> find_emitters(const Scene& scene, const std::vector<std::int32_t>& faces) {
  const MeanEmission emission(scene);
  std::vector<Emitter> emitters;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& triangle = scene.triangles[i];
    const Emitter emitter{triangle.vertex[0],
                          triangle.vertex[1] - triangle.vertex[0],
                          triangle.vertex[2] - triangle.vertex[0],
                          LightShape::triangle,
                          emission.of_triangle(i),
                          triangle.material,
                          faces[i],
                          {i}};
    if (power(emitter) > 0) emitters.push_back(emitter);
  }
  return emitters;
}

/// Replaces two triangles that follow each other by the rectangle that they form.
std::vector<Emitter> join_rectangles(const std::vector<Emitter>& triangles) {
  std::vector<Emitter> emitters;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::optional<Emitter> joined;
    if (i + 1 < triangles.size()) joined = join(triangles[i], triangles[i + 1]);
    emitters.push_back(joined.value_or(triangles[i]));
    if (joined) ++i;
  }
  return emitters;
}

}  // namespace

Lights make_lights(const Scene& scene, const std::vector<std::int32_t>& faces,
                   path_tracer::LightSampling sampling) {
  std::vector<Emitter> emitters = find_emitters(scene, faces);
  if (sampling == path_tracer::LightSampling::solid_angle) emitters = join_rectangles(emitters);
  double total_power = 0;
  for (const Emitter& emitter : emitters) total_power += power(emitter);
  if (!(total_power > 0) && scene.environment.is_lit()) return {};
  if (!(total_power > 0))
    throw InputError(scene.name + ": no triangle emits light; a material with Ke above 0 is needed");

  Lights lights;
  double power_so_far = 0;
  for (const Emitter& emitter : emitters) {
    const double pdf = power(emitter) / total_power / area(emitter);
    LightRecord record;
    record.vertex = to_record(emitter.vertex);
    record.edge1 = to_record(emitter.edge1);
    record.edge2 = to_record(emitter.edge2);
    record.normal = to_record(glm::normalize(glm::cross(emitter.edge1, emitter.edge2)));
    record.inverse_pdf = 1.0 / pdf;
    record.face = emitter.face;
    record.shape = static_cast<std::int32_t>(emitter.shape);
    lights.records.push_back(record);
    lights.triangles.push_back(emitter.triangles);
    power_so_far += power(emitter);
    lights.cdf.push_back(power_so_far / total_power);
  }
  return lights;
}

}  // namespace testbench
