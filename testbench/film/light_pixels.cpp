#include "testbench/film/light_pixels.hpp"

#include <algorithm>
#include <cmath>

#include "testbench/mono_image/faces.hpp"
#include "testbench/scene/normalise.hpp"

namespace testbench {
namespace {

/// A polygon in film coordinates, in pixels.
using FilmPolygon = std::vector<glm::dvec2>;

/// A point in camera coordinates: right, down, depth along the viewing direction.
glm::dvec3 to_camera(const Camera& camera, const glm::dvec3& point) {
  const glm::dvec3 from = point - camera.position;
  return {glm::dot(from, glm::cross(camera.direction, camera.up)), -glm::dot(from, camera.up),
          glm::dot(from, camera.direction)};
}

/// Whether the camera is on the side of the triangle that emits.
bool faces_camera(const Triangle& triangle, const Camera& camera) {
  const glm::dvec3 to_camera =
      camera.orthographic_height ? -camera.direction : camera.position - triangle.vertex[0];
  return glm::dot(area_normal(triangle), to_camera) > 0;
}

/// Projects the part of a triangle in front of the camera (clipped after Sutherland and Hodgman 1974).
FilmPolygon project(const Triangle& triangle, const Camera& camera, const FilmSize& film) {
  glm::dvec3 corner[3];
  double farthest = 0;
  for (int i = 0; i < 3; ++i) {
    corner[i] = to_camera(camera, triangle.vertex[i]);
    farthest = std::max(farthest, corner[i].z);
  }
  if (!(farthest > 0)) return {};
  const bool is_orthographic = camera.orthographic_height.has_value();
  const double near = is_orthographic ? 0.0 : farthest * 1e-6;
  const double film_height =
      camera.orthographic_height.value_or(2 * std::tan(0.5 * camera.vertical_field_of_view_radians));
  const double pixels_per_unit = film.height / film_height;
  FilmPolygon polygon;
  const auto add = [&](const glm::dvec3& p) {
    const double depth = is_orthographic ? 1.0 : p.z;
    polygon.emplace_back(0.5 * film.width + p.x / depth * pixels_per_unit,
                         0.5 * film.height + p.y / depth * pixels_per_unit);
  };
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3& a = corner[i];
    const glm::dvec3& b = corner[(i + 1) % 3];
    if (a.z >= near) add(a);
    if ((a.z >= near) != (b.z >= near)) add(a + (b - a) * ((near - a.z) / (b.z - a.z)));
  }
  return polygon;
}

/// Whether a convex polygon and the unit square at (x, y) overlap, by separating axes. Touching is not
/// overlapping.
bool overlaps(const FilmPolygon& polygon, double x, double y) {
  const auto separated_along = [&](const glm::dvec2& axis) {
    double polygon_low = glm::dot(polygon[0], axis), polygon_high = polygon_low;
    for (const glm::dvec2& p : polygon) {
      polygon_low = std::min(polygon_low, glm::dot(p, axis));
      polygon_high = std::max(polygon_high, glm::dot(p, axis));
    }
    const double square_low = x * axis.x + y * axis.y + std::min(0.0, axis.x) + std::min(0.0, axis.y);
    const double square_high = x * axis.x + y * axis.y + std::max(0.0, axis.x) + std::max(0.0, axis.y);
    return polygon_high <= square_low || square_high <= polygon_low;
  };
  if (separated_along({1, 0}) || separated_along({0, 1})) return false;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 edge = polygon[(i + 1) % polygon.size()] - polygon[i];
    if (separated_along({-edge.y, edge.x})) return false;
  }
  return true;
}

void mark(const FilmPolygon& polygon, const FilmSize& film, std::vector<bool>& marked) {
  if (polygon.size() < 3) return;
  const auto range = [&](auto coordinate, int limit) {
    const auto [low, high] = std::minmax_element(
        polygon.begin(), polygon.end(),
        [&](const glm::dvec2& a, const glm::dvec2& b) { return coordinate(a) < coordinate(b); });
    return std::pair<int, int>(int(std::clamp(std::floor(coordinate(*low)), 0.0, double(limit))),
                               int(std::clamp(std::ceil(coordinate(*high)), 0.0, double(limit))));
  };
  const auto [left, right] = range([](const glm::dvec2& p) { return p.x; }, film.width);
  const auto [top, bottom] = range([](const glm::dvec2& p) { return p.y; }, film.height);
  for (int row = top; row < bottom; ++row)
    for (int column = left; column < right; ++column)
      if (overlaps(polygon, column, row))
        marked[std::size_t(row) * std::size_t(film.width) + std::size_t(column)] = true;
}

}  // namespace

std::vector<bool> light_pixels(const Scene& scene) {
  std::vector<bool> marked(std::size_t(scene.film.width) * std::size_t(scene.film.height));
  const Scene normal = normalised(scene);
  for (const Triangle& triangle : normal.triangles) {
    const Material& material = normal.materials[std::size_t(triangle.material)];
    if (material.emission == glm::dvec3(0.0)) continue;
    if (!faces_camera(triangle, normal.camera)) continue;
    mark(project(triangle, normal.camera, normal.film), normal.film, marked);
  }
  return marked;
}

}  // namespace testbench
