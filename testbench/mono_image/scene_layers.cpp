#include "testbench/mono_image/scene_layers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "testbench/scene/triangle_overlap.hpp"

namespace testbench {
namespace {

using path_tracer::SharedPlane;
using path_tracer::TriangleShape;
using Vector = cn::vec3<double>;

Vector as_record(const glm::dvec3& v) {
  return {v.x, v.y, v.z};
}

/// The plane through far-apart vertices, moved to the middle of all of them.
SharedPlane plane_through(const std::vector<glm::dvec3>& vertices, const glm::dvec3& anchor) {
  const Vector normal = as_record(fit_plane(vertices).normal);
  long double least = std::numeric_limits<long double>::infinity();
  long double most = -least;
  for (const glm::dvec3& vertex : vertices) {
    const cn::vec3<long double> from_anchor{
        (long double)vertex.x - anchor.x, (long double)vertex.y - anchor.y, (long double)vertex.z - anchor.z};
    const long double offset = cn::dot(normal, from_anchor);
    least = std::min(least, offset);
    most = std::max(most, offset);
  }
  return {normal, double(least + (most - least) / 2)};
}

/// Whether all of a triangle lies in the plane. A sliver, whose own plane rounding may have turned, does not.
bool lies_in(const SharedPlane& plane, const Vector& anchor, const Triangle& triangle, double tolerance) {
  constexpr double kLeastCosine = 0.99;
  for (const glm::dvec3& vertex : triangle.vertex)
    if (!(path_tracer::distance_from(plane, anchor, as_record(vertex)) <= tolerance)) return false;
  const glm::dvec3 normal =
      glm::cross(triangle.vertex[1] - triangle.vertex[0], triangle.vertex[2] - triangle.vertex[0]);
  const double along = normal.x * plane.normal.x + normal.y * plane.normal.y + normal.z * plane.normal.z;
  return std::abs(along) >= kLeastCosine * std::hypot(normal.x, normal.y, normal.z);
}

/// Triangles by a number of each of them that is below `numbers`; those with a negative one are left out.
std::vector<std::vector<std::size_t>> by_number(const std::vector<std::int32_t>& number_of,
                                                std::size_t numbers) {
  std::vector<std::vector<std::size_t>> triangles(numbers);
  for (std::size_t i = 0; i < number_of.size(); ++i)
    if (number_of[i] >= 0) triangles[std::size_t(number_of[i])].push_back(i);
  return triangles;
}

}  // namespace

SceneLayers::SceneLayers(const Scene& scene, const CoincidentTriangles& coincident,
                         const std::vector<std::int32_t>& faces) {
  const std::vector<Triangle>& triangles = scene.triangles;
  if (coincident.groups == 0) return;
  const glm::dvec3 anchor = triangles[0].vertex[0];
  const double tolerance = size_of(triangles, scene.rounded_at).plane_tolerance();
  layers_ = {true, as_record(anchor)};
  plane_of_.assign(triangles.size(), kNoPlane);
  // First a plane for each face with coincident triangles, then one for each group that is not in such a
  // plane as a whole: its face is bent by more than rounding.
  const auto add_planes = [&](const std::vector<std::vector<std::size_t>>& sets) {
    for (const std::vector<std::size_t>& set : sets) {
      std::vector<glm::dvec3> vertices;
      for (const std::size_t i : set)
        if (coincident.group[i] != kNoGroup)
          vertices.insert(vertices.end(), std::begin(triangles[i].vertex), std::end(triangles[i].vertex));
      if (vertices.empty()) continue;
      const SharedPlane plane = plane_through(vertices, anchor);
      for (const std::size_t i : set)
        if (lies_in(plane, layers_.anchor, triangles[i], tolerance))
          plane_of_[i] = static_cast<std::int32_t>(planes_.size());
      planes_.push_back(plane);
    }
  };
  add_planes(by_number(faces, faces.size()));
  std::vector<std::vector<std::size_t>> groups = by_number(coincident.group, std::size_t(coincident.groups));
  for (std::vector<std::size_t>& group : groups)
    if (std::all_of(group.begin(), group.end(), [&](std::size_t i) { return plane_of_[i] != kNoPlane; }))
      group.clear();
  add_planes(groups);
}

TriangleShape SceneLayers::shape_of(const Triangle& triangle, std::size_t number) const {
  const Vector vertex[3] = {as_record(triangle.vertex[0]), as_record(triangle.vertex[1]),
                            as_record(triangle.vertex[2])};
  const std::int32_t plane = plane_of(number);
  if (plane != kNoPlane) return path_tracer::lay_into(planes_[std::size_t(plane)], layers_.anchor, vertex);
  return {vertex[0], vertex[1] - vertex[0], vertex[2] - vertex[0]};
}

path_tracer::LayeredTriangleRecord SceneLayers::record_of(const Triangle& triangle,
                                                          const path_tracer::TrianglePlace& place) const {
  const auto number = std::size_t(place.number);
  const TriangleShape shape = shape_of(triangle, number);
  const std::int32_t plane = plane_of(number);
  return plane == kNoPlane ? path_tracer::layered_triangle_record(shape, place, layers_.anchor)
                           : path_tracer::layered_triangle_record(shape, place, layers_.anchor,
                                                                  planes_[std::size_t(plane)]);
}

}  // namespace testbench
