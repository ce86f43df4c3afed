#pragma once

#include <limits>

#include "firmware/cn/language/control.hpp"
#include "firmware/cn/language/exact.hpp"
#include "firmware/path_tracer/geometry/box.hpp"
#include "firmware/path_tracer/geometry/triangle_record.hpp"

namespace path_tracer {

using cn::mask;
using cn::poly;

/// A ray, as every test of a triangle needs it.
struct RayOperands {
  Point3 origin;
  Direction3 direction;
  poly<std::int32_t> left_face;
  bool is_in_layers = false;  ///< whether the scene is layered
  Point3 from_anchor{};       ///< the origin relative to Layers::anchor; of layered scenes only

  void measure_from_anchor(const Layers& layers) {
    is_in_layers = layers.any;
    if (layers.any) from_anchor = origin - layers.anchor;
  }
};

/// One triangle for each PE.
struct PolyTriangle {
  Point3 vertex;
  Direction3 edge1;
  Direction3 edge2;
  Direction3 back;
  poly<std::int32_t> face;
  poly<std::int32_t> number;
  // Of layered scenes only:
  poly<double> plane_offset{};
  poly<double> area_ratio{};
};

/// Charges the control unit's work for a triangle: it fetches 13 mono operands, two more in a layered scene,
/// and runs the loop. Poly operands are charged where they are read.
inline void issue_operands(const TriangleRecord&, bool is_in_layers) {
  cn::issue(cn::InstructionClass::mono, is_in_layers ? 18 : 16);
}
inline void issue_operands(const PolyTriangle&, bool /*is_in_layers*/) {
  cn::issue(cn::InstructionClass::mono, 3);
}

/// As of a TriangleRecord (records.hpp): what has the members of layered scenes.
inline const PolyTriangle& layered(const PolyTriangle& triangle) {
  return triangle;
}

/// Intersection of a line with a triangle, scaled by |determinant| so that the test needs no division:
/// Moeller and Trumbore 1997, comparing numerators instead of quotients. One of their two cross products
/// depends on the triangle only and is in its record, as in Embree (Wald, Woop, Benthin, Johnson, Ernst,
/// SIGGRAPH 2014): 18 multiplications instead of 24.
///
/// In a layered scene distance and determinant come from the plane alone, so triangles that share it have
/// equal quotients of the two. The triangle's own vertex and edges tell what is inside.
struct Crossing {
  poly<double> determinant;  ///< positive when the line meets the front
  poly<double> size;         ///< |determinant|
  poly<double> distance;     ///< distance along the direction * size
  mask inside;               ///< within the triangle and ahead of the origin

  template <class Triangle>
  Crossing(const RayOperands& ray, const Triangle& triangle) {
    issue_operands(triangle, ray.is_in_layers);
    const Direction3 to_vertex = triangle.vertex - ray.origin;
    const Direction3 moment = cross(ray.direction, to_vertex);
    determinant.assign_all_lanes(dot(ray.direction, triangle.back));
    size.assign_all_lanes(cn::abs(determinant));
    const poly<double> along_back = ray.is_in_layers
                                        ? layered(triangle).plane_offset - dot(ray.from_anchor, triangle.back)
                                        : dot(to_vertex, triangle.back);
    distance.assign_all_lanes(cn::flip_sign(along_back, determinant));
    const poly<double> u = cn::flip_sign(dot(moment, triangle.edge2), determinant);
    const poly<double> minus_v = cn::flip_sign(dot(moment, triangle.edge1), determinant);
    const poly<double> most = ray.is_in_layers ? size * layered(triangle).area_ratio : size;
    inside = (u >= 0.0) & (minus_v <= 0.0) & (u - minus_v <= most) & (distance > 0.0);
  }
};

/// The nearest hit so far: what a search starts from and what it finds.
struct Nearest {
  poly<double> distance = std::numeric_limits<double>::infinity();  ///< scaled by |determinant|
  poly<double> determinant = 1.0;
  poly<std::int32_t> number = -1;

  template <class Triangle>
  void take(const Crossing& crossing, const Triangle& triangle) {
    distance = crossing.distance;
    determinant = crossing.determinant;
    number = triangle.number;
  }
};

/// Triangles that the control unit broadcasts to all PEs one after the other.
struct MonoTriangles {
  const TriangleRecord* first;
  int count;
  int record_bytes = sizeof(TriangleRecord);  ///< from one triangle to the next (Layers)

  const TriangleRecord& operator()(int i) const { return triangle_at(first, i, record_bytes); }
  mask where_there(int, const mask& lanes) const { return lanes; }
};

/// Returns the sum of the components' sizes, which is at least the length.
inline poly<double> length_bound(const Direction3& direction) {
  return cn::abs(direction.x) + cn::abs(direction.y) + cn::abs(direction.z);
}

/// Whether rounding cannot have moved the hit out of the triangle's padded box (triangle_record.hpp).
inline mask is_certain(const poly<double>& determinant, const RayOperands& ray) {
  return cn::abs(determinant) >= length_bound(ray.direction);
}

inline Direction3 as_poly(const vec3<double>& v) {
  return {v.x, v.y, v.z};
}
inline const Direction3& as_poly(const Direction3& v) {
  return v;
}

/// Tests the padded box itself, for a hit that is not certain to lie in it.
template <class Triangle>
mask meets_padded_box(const RayOperands& ray, double reach, const Crossing& crossing,
                      const Triangle& triangle) {
  // The power of two that scales the edges: edge2 x edge1 has its square, `back` has it once; in a layered
  // scene `back` times the area's ratio has it once.
  const Direction3 edge1 = as_poly(triangle.edge1);
  const Direction3 edge2 = as_poly(triangle.edge2);
  const Direction3 back = as_poly(triangle.back);
  const poly<double> squared =
      ray.is_in_layers ? dot(back, back) * layered(triangle).area_ratio : dot(back, back);
  const poly<double> ratio = dot(cross(edge2, edge1), back) / squared;
  const poly<double> inverse_scale = cn::inverse_power_of_two(cn::nearest_power_of_two(ratio));
  const PaddedBox<poly<double>> box =
      padded_box(as_poly(triangle.vertex), edge1 * inverse_scale, edge2 * inverse_scale, reach);
  const BoxRay box_ray(ray.origin, ray.direction);
  const Slabs slabs = box_ray.slabs(box.lower, box.upper);
  return (slabs.entry <= slabs.exit) & (slabs.entry <= latest_entry(crossing.distance / crossing.size));
}

/// Whether a crossing as far along the ray as `nearest` comes before it: by number. In a layered scene what
/// faces the ray comes first, so that of two surfaces back to back each is seen from its own side.
template <class Found>
mask is_seen_first(const RayOperands& ray, const Crossing& crossing, const poly<std::int32_t>& number,
                   const Found& nearest) {
  const mask is_lower = number < nearest.number;
  if (!ray.is_in_layers) return is_lower;
  const mask faces = crossing.determinant > 0.0;
  const mask turned_away = nearest.determinant < 0.0;
  return (faces & turned_away) | ((faces | turned_away) & is_lower);
}

/// Whether `crossing` comes before `nearest`: by the exact quotients of the computed distances and
/// determinants, then by is_seen_first(). Every search keeps to this order, in whatever order it meets the
/// triangles.
template <class Found>
mask comes_before(const RayOperands& ray, const Crossing& crossing, const poly<std::int32_t>& number,
                  const Found& nearest) {
  const poly<double> nearest_size = cn::abs(nearest.determinant);
  const poly<double> left = crossing.distance * nearest_size;
  const poly<double> right = nearest.distance * crossing.size;
  const poly<double> left_error = cn::product_error(crossing.distance, nearest_size, left);
  const poly<double> right_error = cn::product_error(nearest.distance, crossing.size, right);
  const mask same = (left == right) & (left_error == right_error);
  return (left < right) | ((left == right) & (left_error < right_error)) |
         (same & is_seen_first(ray, crossing, number, nearest));
}

/// Takes `triangle` where it is a candidate and nearer than `nearest`. Returns the lanes where it is as near.
template <class Found, class Triangle>
mask take_nearer(const Crossing& crossing, const Triangle& triangle, const mask& candidate, Found& nearest) {
  const poly<double> left = crossing.distance * cn::abs(nearest.determinant);
  const poly<double> right = nearest.distance * crossing.size;
  const mask as_near = candidate & (left == right);
  cn::poly_if(candidate & (left < right), [&] { nearest.take(crossing, triangle); });
  return as_near;
}

/// Searches without regard to rounding. Returns the lanes in which two crossings were too close to tell which
/// is nearer.
template <class Found, class Triangles>
mask search_fast(const RayOperands& ray, const Triangles& triangles, Found& nearest) {
  mask tied(cn::mask_from_bits(0));
  for (int i = 0; i < triangles.count; ++i) {
    const auto& triangle = triangles(i);
    const Crossing crossing(ray, triangle);
    const mask candidate =
        triangles.where_there(i, crossing.inside & (ray.left_face != poly<std::int32_t>(triangle.face)));
    tied = tied | take_nearer(crossing, triangle, candidate, nearest);
  }
  return tied;
}

/// Whether rounding has not moved the hit out of the triangle's padded box. Layered scenes have many ties, so
/// there the box is tested only if a PE needs it.
template <class Triangle>
mask is_in_padded_box(const RayOperands& ray, double reach, const Crossing& crossing,
                      const Triangle& triangle, const mask& candidate) {
  const mask certain = is_certain(crossing.determinant, ray);
  if (!ray.is_in_layers) return certain | meets_padded_box(ray, reach, crossing, triangle);
  mask in_box = certain;
  cn::poly_if_any(candidate & !certain,
                  [&] { in_box = certain | meets_padded_box(ray, reach, crossing, triangle); });
  return in_box;
}

template <class Found, class Triangles>
void search_exactly(const RayOperands& ray, double reach, const Triangles& triangles, Found& nearest) {
  for (int i = 0; i < triangles.count; ++i) {
    const auto& triangle = triangles(i);
    const Crossing crossing(ray, triangle);
    const mask candidate =
        triangles.where_there(i, crossing.inside & (ray.left_face != poly<std::int32_t>(triangle.face)));
    const mask valid = candidate & is_in_padded_box(ray, reach, crossing, triangle, candidate);
    cn::poly_if(valid & comes_before(ray, crossing, poly<std::int32_t>(triangle.number), nearest),
                [&] { nearest.take(crossing, triangle); });
  }
}

/// The fast part of a search as the Cn code has it: each PE tests each triangle.
struct FastSearch {
  template <class Found, class Triangles>
  mask operator()(const RayOperands& ray, const Triangles& triangles, Found& nearest) const {
    return search_fast(ray, triangles, nearest);
  }
};

/// Replaces `nearest` by the nearest of `triangles` where that comes before it. A ray ignores the face that
/// it leaves. The exact search runs only if a PE needs it: where the fast one met no tie and its result is
/// certain, no other crossing can come before that result.
/// @param fast finds what FastSearch finds
template <class Fast, class Found, class Triangles>
void search_by(const Fast& fast, const RayOperands& ray, double reach, const Triangles& triangles,
               Found& nearest) {
  const Found start = nearest;
  const mask tied = fast(ray, triangles, nearest);
  const mask changed = nearest.number != start.number;
  cn::poly_if_any(tied | (changed & !is_certain(nearest.determinant, ray)), [&] {
    nearest = start;
    search_exactly(ray, reach, triangles, nearest);
  });
}

/// search_by() with each PE testing each triangle.
template <class Found, class Triangles>
void search(const RayOperands& ray, double reach, const Triangles& triangles, Found& nearest) {
  search_by(FastSearch{}, ray, reach, triangles, nearest);
}

}  // namespace path_tracer
