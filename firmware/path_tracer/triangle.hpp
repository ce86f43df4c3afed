#pragma once

#include <limits>

#include "firmware/cn/control.hpp"
#include "firmware/path_tracer/records.hpp"

namespace path_tracer {

using cn::mask;
using cn::poly;
using Direction3 = vec3<poly<double>>;
using Point3 = vec3<poly<double>>;

/// A line against a triangle, scaled by |determinant| so that no division is needed to test it: Moeller and
/// Trumbore 1997, with numerators compared instead of quotients. Of their two cross products the one that is
/// the triangle's alone is in its record, as Embree has it (Wald, Woop, Benthin, Johnson, Ernst, SIGGRAPH
/// 2014): 18 multiplications instead of 24.
struct Crossing {
  poly<double> determinant;  ///< positive when the line meets the front
  poly<double> size;         ///< |determinant|
  poly<double> distance;     ///< distance along the direction * size
  mask inside;               ///< within the triangle and ahead of the origin

  Crossing(const Point3& origin, const Direction3& direction, const TriangleRecord& triangle) {
    // The control unit fetches 13 mono operands and turns the loop.
    cn::issue(cn::InstructionClass::mono, 16);
    const Direction3 to_vertex = triangle.vertex - origin;
    const Direction3 moment = cross(direction, to_vertex);
    determinant.become(dot(direction, triangle.back));
    size.become(cn::abs(determinant));
    distance.become(cn::flip_sign(dot(to_vertex, triangle.back), determinant));
    const poly<double> u = cn::flip_sign(dot(moment, triangle.edge2), determinant);
    const poly<double> minus_v = cn::flip_sign(dot(moment, triangle.edge1), determinant);
    inside = (u >= 0.0) & (minus_v <= 0.0) & (u - minus_v <= size) & (distance > 0.0);
  }
};

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
    const Crossing crossing(origin, direction, triangles[i]);
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
