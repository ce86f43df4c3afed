#include "testbench/scene/triangle_overlap.hpp"

#include <algorithm>
#include <cmath>

#include "testbench/scene/triangle_bounds.hpp"

namespace testbench {
namespace {

glm::dvec3 edge_normal(const Triangle& triangle) {
  return glm::cross(triangle.vertex[1] - triangle.vertex[0], triangle.vertex[2] - triangle.vertex[0]);
}

int largest_axis(const glm::dvec3& v) {
  const glm::dvec3 size = glm::abs(v);
  return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Whether the line along an edge of `a` has all of `b` on its other side, or at most `tolerance` beyond.
bool edge_parts(const Silhouette& a, const Silhouette& b, double tolerance) {
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec2 along = a[(i + 1) % 3] - a[i];
    const auto beyond = [&](const glm::dvec2& corner) {
      const glm::dvec2 to = corner - a[i];
      return along.x * to.y - along.y * to.x;
    };
    if (std::max({beyond(b[0]), beyond(b[1]), beyond(b[2])}) <= tolerance * glm::length(along)) return true;
  }
  return false;
}

template <class Distance>  // (point) -> double
const glm::dvec3& farthest(const std::vector<glm::dvec3>& points, const Distance& distance) {
  return *std::max_element(points.begin(), points.end(), [&](const glm::dvec3& a, const glm::dvec3& b) {
    return distance(a) < distance(b);
  });
}

}  // namespace

SceneSize size_of(const std::vector<Triangle>& triangles, double rounded_at) {
  if (triangles.empty()) return {};
  const TriangleBounds bounds = bounds_of(triangles);
  const glm::dvec3 most = glm::max(glm::abs(bounds.lower), glm::abs(bounds.upper));
  const glm::dvec3 box = bounds.sides();
  const double extent = std::hypot(box.x, box.y, box.z);
  return {extent, std::max({extent, most.x, most.y, most.z, rounded_at})};
}

FittedPlane fit_plane(const std::vector<glm::dvec3>& points) {
  const auto distance_from = [](const glm::dvec3& from) {
    return [from](const glm::dvec3& point) { return glm::length(point - from); };
  };
  const glm::dvec3 first = farthest(points, distance_from(points[0]));
  const glm::dvec3 second = farthest(points, distance_from(first));
  const double length = glm::length(second - first);
  const glm::dvec3 along = length > 0 ? (second - first) / length : glm::dvec3(1.0, 0.0, 0.0);
  const auto across = [&](const glm::dvec3& point) { return glm::length(glm::cross(along, point - first)); };
  const glm::dvec3 third = farthest(points, across);
  const glm::dvec3 normal = glm::cross(along, third - first);
  return {first, normal / glm::length(normal)};
}

double height_of(const Triangle& triangle) {
  const double longest = std::max({glm::length(triangle.vertex[1] - triangle.vertex[0]),
                                   glm::length(triangle.vertex[2] - triangle.vertex[0]),
                                   glm::length(triangle.vertex[2] - triangle.vertex[1])});
  return longest > 0 ? glm::length(edge_normal(triangle) / longest) : 0.0;
}

Silhouette seen_along(int axis, const Triangle& triangle, const glm::dvec3& origin) {
  Silhouette corners;
  for (std::size_t i = 0; i < 3; ++i) {
    const glm::dvec3 at = triangle.vertex[i] - origin;
    corners[i] = {at[(axis + 1) % 3], at[(axis + 2) % 3]};
  }
  const glm::dvec2 a = corners[1] - corners[0];
  const glm::dvec2 b = corners[2] - corners[0];
  if (a.x * b.y < a.y * b.x) std::swap(corners[1], corners[2]);
  return corners;
}

bool overlap(const Silhouette& a, const Silhouette& b, const SceneSize& size) {
  const double touching = 4 * size.plane_tolerance();
  return !edge_parts(a, b, touching) && !edge_parts(b, a, touching);
}

bool lie_in_one_plane(const Triangle& a, const Triangle& b, const SceneSize& size) {
  const std::vector<glm::dvec3> points{a.vertex[0], a.vertex[1], a.vertex[2],
                                       b.vertex[0], b.vertex[1], b.vertex[2]};
  const FittedPlane plane = fit_plane(points);
  return std::all_of(points.begin(), points.end(), [&](const glm::dvec3& point) {
    return std::abs(glm::dot(plane.normal, point - plane.point)) <= size.plane_tolerance();
  });
}

bool coincide(const Triangle& a, const Triangle& b, const SceneSize& size) {
  const int axis = largest_axis(edge_normal(height_of(a) < height_of(b) ? b : a));
  const glm::dvec3& origin = a.vertex[0];
  return overlap(seen_along(axis, a, origin), seen_along(axis, b, origin), size) &&
         lie_in_one_plane(a, b, size);
}

}  // namespace testbench
