#include "testbench/mono_image/emitter.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "testbench/mono_image/mean_emission.hpp"
#include "testbench/mono_image/to_record.hpp"

namespace testbench {
namespace {

using path_tracer::LightShape;

/// An emitting triangle or rectangle.
struct EmittingPart {
  glm::dvec3 vertex;
  glm::dvec3 edge1;
  glm::dvec3 edge2;
  LightShape shape;
  glm::dvec3 emission;  ///< mean radiance, estimated
  std::int32_t material;
  std::int32_t face;
  std::vector<std::size_t> triangles;
};

double area(const EmittingPart& part) {
  const double parallelogram = glm::length(glm::cross(part.edge1, part.edge2));
  return part.shape == LightShape::triangle ? 0.5 * parallelogram : parallelogram;
}

/// The radiant power, up to a common factor.
double power(const EmittingPart& part) {
  const glm::dvec3& emission = part.emission;
  return area(part) * (emission.x + emission.y + emission.z);
}

/// The rectangle that two triangles of one face and material form; std::nullopt if they form none. The
/// tolerance for rounding is 2^-40.
std::optional<EmittingPart> join(const EmittingPart& a, const EmittingPart& b) {
  constexpr double kTolerance = 0x1p-40;
  if (a.face != b.face || a.material != b.material) return {};
  const glm::dvec3 corners_a[3] = {a.vertex, a.vertex + a.edge1, a.vertex + a.edge2};
  const glm::dvec3 corners_b[3] = {b.vertex, b.vertex + b.edge1, b.vertex + b.edge2};
  for (int i = 0; i < 3; ++i) {
    // The right angle lies at a corner of `a`, the opposite corner is one of `b`.
    EmittingPart joined = a;
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

std::vector<EmittingPart> emitting_triangles(const Scene& scene, const std::vector<std::int32_t>& faces) {
  const MeanEmission emission(scene);
  std::vector<EmittingPart> parts;
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    const Triangle& triangle = scene.triangles[i];
    const EmittingPart part{triangle.vertex[0],
                            triangle.vertex[1] - triangle.vertex[0],
                            triangle.vertex[2] - triangle.vertex[0],
                            LightShape::triangle,
                            emission.of_triangle(i),
                            triangle.material,
                            faces[i],
                            {i}};
    if (power(part) > 0) parts.push_back(part);
  }
  return parts;
}

/// Replaces two triangles that follow each other by the rectangle that they form.
std::vector<EmittingPart> join_rectangles(const std::vector<EmittingPart>& triangles) {
  std::vector<EmittingPart> parts;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::optional<EmittingPart> joined;
    if (i + 1 < triangles.size()) joined = join(triangles[i], triangles[i + 1]);
    parts.push_back(joined.value_or(triangles[i]));
    if (joined) ++i;
  }
  return parts;
}

Emitter emitter_of(const EmittingPart& part) {
  Emitter emitter;
  emitter.record.vertex = to_record(part.vertex);
  emitter.record.edge1 = to_record(part.edge1);
  emitter.record.edge2 = to_record(part.edge2);
  emitter.record.normal = to_record(glm::normalize(glm::cross(part.edge1, part.edge2)));
  emitter.record.face = part.face;
  emitter.record.shape = static_cast<std::int32_t>(part.shape);
  emitter.measure = area(part);
  emitter.emission = part.emission;
  emitter.power = power(part);
  const double to_centre = part.shape == LightShape::triangle ? 1.0 / 3.0 : 0.5;
  emitter.centre = part.vertex + to_centre * (part.edge1 + part.edge2);
  emitter.material = part.material;
  emitter.triangles = part.triangles;
  return emitter;
}

}  // namespace

std::vector<Emitter> surface_emitters(const Scene& scene, const std::vector<std::int32_t>& faces,
                                      path_tracer::LightSampling sampling) {
  std::vector<EmittingPart> parts = emitting_triangles(scene, faces);
  if (sampling == path_tracer::LightSampling::solid_angle) parts = join_rectangles(parts);
  std::vector<Emitter> emitters;
  emitters.reserve(parts.size());
  for (const EmittingPart& part : parts) emitters.push_back(emitter_of(part));
  return emitters;
}

}  // namespace testbench
