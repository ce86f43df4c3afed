#include "testbench/scene/polygon.hpp"

#include <GL/glu.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <memory>
#include <optional>

#include "testbench/scene/mesh.hpp"
#include "testbench/scene/polygon_crossings.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// Trying all fans of a polygon takes a time that grows with the square of its size.
constexpr std::size_t kLargestPolygonOfAnyFan = 255;

glm::dvec3 area_vector(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return glm::cross(b - a, c - a);
}

/// Whether the fan from vertex `start` covers the polygon with triangles that all face the same way as the
/// polygon.
bool is_fan_start(const Polygon& polygon, std::size_t start, const glm::dvec3& normal, double tolerance) {
  const std::size_t count = polygon.size();
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const glm::dvec3 area =
        area_vector(polygon[start], polygon[(start + i) % count], polygon[(start + i + 1) % count]);
    const double facing = glm::dot(area, normal);
    if (!(tolerance == 0.0 ? facing > 0.0 : facing >= -tolerance * glm::dot(normal, normal))) return false;
  }
  return true;
}

/// Newell's normal: twice the vector area, for any planar or bent polygon.
glm::dvec3 newell_normal(const Polygon& polygon) {
  glm::dvec3 normal(0.0);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    normal += area_vector(polygon[0], polygon[i], polygon[i + 1]);
  return normal;
}

/// The vertex whose fan triangulates the polygon, which is the first one for every convex polygon;
/// std::nullopt if no fan does. A fan of proper triangles is preferred to one with collinear vertices.
std::optional<std::size_t> fan_start(const Polygon& polygon, const glm::dvec3& normal) {
  if (normal == glm::dvec3(0.0)) {  // a line, or a polygon that crosses itself and whose parts cancel
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      if (!is_degenerate({{polygon[0], polygon[i], polygon[i + 1]}, 0})) return std::nullopt;
    }
    return 0;
  }
  const std::size_t starts = polygon.size() <= kLargestPolygonOfAnyFan ? polygon.size() : 1;
  for (const double tolerance : {0.0, 1e-12}) {
    for (std::size_t start = 0; start < starts; ++start) {
      if (is_fan_start(polygon, start, normal, tolerance)) return start;
    }
  }
  return std::nullopt;
}

/// A point that GLU is given or makes, and the corner of the polygon that it is or lies nearest to.
struct TessellationPoint {
  glm::dvec3 place;
  std::uint32_t corner;
};

/// What GLU's callbacks work on.
struct Tessellation {
  std::deque<TessellationPoint> points;  ///< a deque, because GLU keeps pointers to them
  std::vector<const TessellationPoint*> corners;
  bool crosses_itself = false;
  GLenum error = 0;
};

// The edge flag's callback does nothing, but with it GLU makes triangles only, not fans and strips.
void on_edge_flag(GLboolean) {}

void on_vertex(void* vertex, void* tessellation) {
  static_cast<Tessellation*>(tessellation)->corners.push_back(static_cast<const TessellationPoint*>(vertex));
}

/// Called where vertices coincide, and where edges cross.
void on_combine(const GLdouble place[3], void* vertices[4], const GLfloat weights[4], void** result,
                void* tessellation) {
  auto& state = *static_cast<Tessellation*>(tessellation);
  const glm::dvec3 point(place[0], place[1], place[2]);
  const auto nearest = std::size_t(std::max_element(weights, weights + 4) - weights);
  if (point != static_cast<const TessellationPoint*>(vertices[0])->place) state.crosses_itself = true;
  state.points.push_back({point, static_cast<const TessellationPoint*>(vertices[nearest])->corner});
  *result = &state.points.back();
}

void on_error(GLenum error, void* tessellation) {
  static_cast<Tessellation*>(tessellation)->error = error;
}

template <class Function>
_GLUfuncptr callback(Function* function) {
  return reinterpret_cast<_GLUfuncptr>(function);
}

void run_glu(const glm::dvec3& normal, Tessellation& state) {
  const std::unique_ptr<GLUtesselator, void (*)(GLUtesselator*)> glu(gluNewTess(), gluDeleteTess);
  if (!glu) throw RunError("a polygon cannot be triangulated: out of memory");
  gluTessCallback(glu.get(), GLU_TESS_EDGE_FLAG, callback(on_edge_flag));
  gluTessCallback(glu.get(), GLU_TESS_VERTEX_DATA, callback(on_vertex));
  gluTessCallback(glu.get(), GLU_TESS_COMBINE_DATA, callback(on_combine));
  gluTessCallback(glu.get(), GLU_TESS_ERROR_DATA, callback(on_error));
  gluTessProperty(glu.get(), GLU_TESS_WINDING_RULE, GLU_TESS_WINDING_NONZERO);
  gluTessNormal(glu.get(), normal.x, normal.y, normal.z);
  gluTessBeginPolygon(glu.get(), &state);
  gluTessBeginContour(glu.get());
  const std::size_t count = state.points.size();  // on_combine adds more
  for (std::size_t i = 0; i < count; ++i) {
    TessellationPoint& point = state.points[i];
    GLdouble place[3] = {point.place.x, point.place.y, point.place.z};
    gluTessVertex(glu.get(), place, &point);
  }
  gluTessEndContour(glu.get());
  gluTessEndPolygon(glu.get());
}

/// The power of two that brings the extent of the polygon near 1. It changes no digit, and products of what
/// is left neither overflow nor vanish.
int exponent_of(const Polygon& polygon) {
  double largest = 0.0;
  for (const glm::dvec3& point : polygon)
    for (int axis = 0; axis < 3; ++axis)
      largest = std::max(largest, std::abs(point[axis] - polygon.front()[axis]));
  return largest > 0.0 ? std::max(std::ilogb(largest), -1000) : 0;
}

/// The polygon as GLU sees it: without the axis to which it is most perpendicular.
std::vector<glm::dvec2> outline_of(const Polygon& polygon, const glm::dvec3& normal) {
  glm::dvec3 lower = polygon.front();
  glm::dvec3 upper = polygon.front();
  for (const glm::dvec3& point : polygon) {
    lower = glm::min(lower, point);
    upper = glm::max(upper, point);
  }
  const glm::dvec3 thickness = lower - upper;
  const glm::dvec3 left_out = normal == glm::dvec3(0.0) ? thickness : glm::abs(normal);
  int axis = left_out.y > left_out.x ? 1 : 0;
  if (left_out.z > left_out[axis]) axis = 2;
  std::vector<glm::dvec2> outline;
  outline.reserve(polygon.size());
  for (const glm::dvec3& point : polygon) outline.emplace_back(point[(axis + 1) % 3], point[(axis + 2) % 3]);
  return outline;
}

void tessellate(const Polygon& polygon, const glm::dvec3& normal, PolygonTriangles& result) {
  if (!has_few_crossings(outline_of(polygon, normal))) {
    result.is_too_tangled = true;
    return;
  }
  Tessellation state;
  for (const glm::dvec3& point : polygon)
    state.points.push_back({point, static_cast<std::uint32_t>(state.points.size())});
  const double length = std::max({std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)});
  run_glu(length > 0.0 ? normal / length : normal, state);
  if (state.error == GLU_OUT_OF_MEMORY)
    throw RunError("a polygon of " + std::to_string(polygon.size()) +
                   " vertices cannot be triangulated: out of memory");
  for (std::size_t i = 0; i + 2 < state.corners.size(); i += 3) {
    const TessellationPoint* const* const of = &state.corners[i];
    result.triangles.push_back({of[0]->place, of[1]->place, of[2]->place});
    result.corners.push_back({of[0]->corner, of[1]->corner, of[2]->corner});
  }
  if (state.crosses_itself) result.crosses_itself = true;
}

void triangulate_scaled(const Polygon& polygon, PolygonTriangles& result) {
  const std::size_t count = polygon.size();
  const glm::dvec3 normal = newell_normal(polygon);
  const std::optional<std::size_t> start = fan_start(polygon, normal);
  if (!start) return tessellate(polygon, normal, result);
  for (std::size_t i = 1; i + 1 < count; ++i) {
    const std::size_t corners[3] = {*start, (*start + i) % count, (*start + i + 1) % count};
    result.triangles.push_back({polygon[corners[0]], polygon[corners[1]], polygon[corners[2]]});
    result.corners.push_back(
        {std::uint32_t(corners[0]), std::uint32_t(corners[1]), std::uint32_t(corners[2])});
  }
}

}  // namespace

void triangulate(const Polygon& polygon, PolygonTriangles& result) {
  constexpr int kLargestExponent = 64;  // the fourth powers of extents up to here are numbers
  const int exponent = exponent_of(polygon);
  if (std::abs(exponent) <= kLargestExponent) return triangulate_scaled(polygon, result);
  Polygon scaled = polygon;
  for (glm::dvec3& point : scaled) point *= std::ldexp(1.0, -exponent);
  const std::size_t first = result.triangles.size();
  triangulate_scaled(scaled, result);
  for (std::size_t i = first; i < result.triangles.size(); ++i)
    for (glm::dvec3& point : result.triangles[i]) point *= std::ldexp(1.0, exponent);
}

}  // namespace testbench
