#pragma once

#include <limits>

#include "firmware/cn/control.hpp"
#include "firmware/path_tracer/records.hpp"

namespace path_tracer {

using cn::mask;
using cn::poly;
using Direction3 = vec3<poly<double>>;
using Point3 = vec3<poly<double>>;

/// A line against a triangle, scaled by |determinant| so that no division is needed to test it (Moeller and
/// Trumbore 1997, with numerators compared instead of quotients).
struct Crossing {
  poly<double> determinant;  ///< positive when the line meets the front
  poly<double> size;         ///< |determinant|
  poly<double> distance;     ///< distance along the direction * size
  mask inside;               ///< within the triangle and ahead of the origin
};

inline Crossing cross_triangle(const Point3& origin, const Direction3& direction,
                               const TriangleRecord& triangle) {
  // The control unit fetches ten mono operands and turns the loop.
  cn::issue(cn::InstructionClass::mono, 13);
  const Direction3 p = cross(direction, triangle.edge2);
  const poly<double> determinant = dot(p, triangle.edge1);
  const Direction3 s = origin - triangle.vertex;
  const Direction3 q = cross(s, triangle.edge1);
  const poly<double> size = cn::abs(determinant);
  const poly<double> u = cn::flip_sign(dot(s, p), determinant);
  const poly<double> v = cn::flip_sign(dot(direction, q), determinant);
  const poly<double> distance = cn::flip_sign(dot(q, triangle.edge2), determinant);
  const mask inside = (u >= 0.0) & (v >= 0.0) & (u + v <= size) & (distance > 0.0);
  return {determinant, size, distance, inside};
}

struct Nearest {
  poly<double> distance = std::numeric_limits<double>::infinity();  ///< scaled by |determinant|
  poly<double> determinant = 1.0;
  poly<std::int32_t> triangle = -1;
};

/// Tests every triangle; a ray ignores the face that it leaves.
inline Nearest nearest_triangle(const Point3& origin, const Direction3& direction,
                                const poly<std::int32_t>& left_face, const TriangleRecord* triangles,
                                int triangle_count) {
  Nearest nearest;
  for (int i = 0; i < triangle_count; ++i) {
    const Crossing crossing = cross_triangle(origin, direction, triangles[i]);
    const mask nearer = crossing.distance * cn::abs(nearest.determinant) < nearest.distance * crossing.size;
    cn::poly_if(crossing.inside & nearer & (left_face != triangles[i].face), [&] {
      nearest.distance = crossing.distance;
      nearest.determinant = crossing.determinant;
      nearest.triangle = i;
    });
  }
  return nearest;
}

}  // namespace path_tracer
