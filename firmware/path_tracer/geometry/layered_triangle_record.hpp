#pragma once

#include "firmware/path_tracer/geometry/triangle_record.hpp"

/// Triangles of layered scenes. Triangles that lie on one another in one plane have a common `back` and
/// offset, each up to the same power of two and sign, so their quotients of distance and determinant are
/// equal to the last bit on every ray.
///
/// With e = 2^-53 and the other names of triangle_record.hpp, the rounding of a distance is that of the
/// offset (1 e), of the origin relative to the anchor (1 e), of a dot product (3 e) and of a difference (2
/// e), each of reach |back|, and of the determinant (3 e reach |back|): less than the 20 that are allowed for
/// there. The area's ratio adds two roundings to the 36 of a hit within the triangle, and edges that were
/// laid into the plane (lay_into()) two more; together they are below 64. What remains is the vertex, off the
/// plane by its rounding d: it moves the triangle by less than d |direction| |edge1| |edge2| / s along the
/// plane, and the hit by as much along the ray. So is_certain() allows for 4 d besides.
namespace path_tracer {

/// The plane normal . (point - anchor) = offset.
struct SharedPlane {
  vec3<double> normal{};  ///< of a length near 1
  double offset = 0;
};

/// A triangle as its record holds it, before it is scaled.
struct TriangleShape {
  vec3<double> vertex{};
  vec3<double> edge1{};
  vec3<double> edge2{};
};

namespace layered_detail {

using Long3 = vec3<long double>;

inline Long3 widened(const vec3<double>& v) {
  return {v.x, v.y, v.z};
}
inline vec3<double> narrowed(const Long3& v) {
  return {double(v.x), double(v.y), double(v.z)};
}

/// How far a point lies from the plane on the normal's side, in lengths of the normal.
inline long double height_above(const SharedPlane& plane, const vec3<double>& anchor, const Long3& point) {
  const Long3 normal = widened(plane.normal);
  return (cn::dot(normal, point - anchor) - plane.offset) / cn::dot(normal, normal);
}

}  // namespace layered_detail

/// How far a point lies from the plane.
inline double distance_from(const SharedPlane& plane, const vec3<double>& anchor, const vec3<double>& point) {
  const layered_detail::Long3 normal = layered_detail::widened(plane.normal);
  const long double height = layered_detail::height_above(plane, anchor, layered_detail::widened(point));
  return double(std::abs(height) * std::sqrt(cn::dot(normal, normal)));
}

/// Moves a triangle into the plane, across it. Its edges are laid there before they are rounded, so that
/// their rounding is small beside themselves.
inline TriangleShape lay_into(const SharedPlane& plane, const vec3<double>& anchor,
                              const vec3<double> (&vertex)[3]) {
  using namespace layered_detail;
  const auto laid = [&](const vec3<double>& point) {
    const Long3 wide = widened(point);
    return wide - widened(plane.normal) * height_above(plane, anchor, wide);
  };
  const Long3 first = laid(vertex[0]);
  return {narrowed(first), narrowed(laid(vertex[1]) - first), narrowed(laid(vertex[2]) - first)};
}

/// Makes the record of a triangle with a plane of its own.
inline LayeredTriangleRecord layered_triangle_record(const TriangleShape& shape, const TrianglePlace& place,
                                                     const vec3<double>& anchor) {
  using namespace layered_detail;
  LayeredTriangleRecord record;
  record.triangle = triangle_record(shape.vertex, shape.edge1, shape.edge2, place);
  record.plane_offset =
      double(cn::dot(widened(record.triangle.back), widened(shape.vertex) - widened(anchor)));
  return record;
}

/// Makes the record of a triangle that was laid into a plane.
inline LayeredTriangleRecord layered_triangle_record(const TriangleShape& shape, const TrianglePlace& place,
                                                     const vec3<double>& anchor, const SharedPlane& plane) {
  using namespace layered_detail;
  const double deviation = 4 * distance_from(plane, anchor, shape.vertex);
  const double scale = record_scale(shape.vertex, shape.edge1, shape.edge2, place.reach, deviation);
  const Long3 normal = widened(plane.normal);
  const long double along = cn::dot(back_of(shape.edge1, shape.edge2), normal) / cn::dot(normal, normal) *
                            static_cast<long double>(scale);
  const double factor = std::copysign(std::scalbn(1.0, std::ilogb(along)), double(along));
  LayeredTriangleRecord record;
  record.triangle = {shape.vertex,          shape.edge1 * scale, shape.edge2 * scale,
                     plane.normal * factor, place.face,          place.number};
  record.plane_offset = plane.offset * factor;
  record.area_ratio = double(along / factor);
  return record;
}

}  // namespace path_tracer
