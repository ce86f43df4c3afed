#pragma once

#include <algorithm>
#include <cmath>

#include "firmware/path_tracer/records/records.hpp"

/// Boxes that contain a triangle's hits for certain, so that a tree of boxes finds the same hits as a test of
/// every triangle, to the last bit.
///
/// The test (triangle.hpp) rounds. A ray that misses a triangle by a rounding error may count as a hit, and
/// one that grazes its plane may count as a hit far from it. So boxes are padded. If a hit's determinant is
/// so small that rounding may have moved the hit out of the padded box, the ray must also pass the test of
/// that box (box.hpp); then it passes the test of every box around it. All other hits pass it anyway:
///
/// Let e = 2^-53, `reach` at least the distance of any ray's origin from any vertex, and s the size of the
/// determinant. The rounding of the test moves a hit within the triangle by less than 36 e |direction| reach
/// |edge1| |edge2| / s, and along the ray by less than 20 of the same. The test of boxes rounds by at most 16
/// e reach. So if s / |direction| is at least 64 e reach |edge1| |edge2| / padding, with a padding of at
/// least 2^-40 reach, the padded box is met, and not behind the hit.
namespace path_tracer {

template <class Number>
struct PaddedBox {
  vec3<Number> lower;
  vec3<Number> upper;
  Number padding;
};

inline constexpr double kPaddingOfExtent = 0x1p-14;
inline constexpr double kPaddingOfReach = 0x1p-40;
inline constexpr double kRoundings = 64 * 0x1p-53;

/// Computes the padded box, with the same operations in the same order for mono and poly numbers.
/// @param edge1 not scaled
template <class Number>
PaddedBox<Number> padded_box(const vec3<Number>& vertex, const vec3<Number>& edge1, const vec3<Number>& edge2,
                             double reach) {
  using std::max;
  using std::min;
  const vec3<Number> b = vertex + edge1;
  const vec3<Number> c = vertex + edge2;
  const vec3<Number> lower{min(min(vertex.x, b.x), c.x), min(min(vertex.y, b.y), c.y),
                           min(min(vertex.z, b.z), c.z)};
  const vec3<Number> upper{max(max(vertex.x, b.x), c.x), max(max(vertex.y, b.y), c.y),
                           max(max(vertex.z, b.z), c.z)};
  const vec3<Number> size = upper - lower;
  const Number extent = max(max(size.x, size.y), size.z);
  const Number padding = max(Number(extent * kPaddingOfExtent), Number(reach * kPaddingOfReach));
  const vec3<Number> paddings{padding, padding, padding};
  return {lower - paddings, upper + paddings, padding};
}

/// Returns the power of two that scales edges and `back`. With it, a hit is certain to lie in the padded box
/// if the determinant's size is at least the sum of the direction's components. The test of a triangle is the
/// same at every scale, and this scale keeps its products far from overflow and underflow.
/// @param deviation by how much hits may be off besides rounding (layered_triangle_record.hpp)
inline double record_scale(const vec3<double>& vertex, const vec3<double>& edge1, const vec3<double>& edge2,
                           double reach, double deviation = 0) {
  const auto length = [](const vec3<double>& v) {
    return std::hypot(static_cast<long double>(v.x), static_cast<long double>(v.y),
                      static_cast<long double>(v.z));
  };
  const double padding = padded_box(vertex, edge1, edge2, reach).padding;
  const long double least =
      (kRoundings * reach + deviation) * length(edge1) * length(edge2) / static_cast<long double>(padding);
  if (!(least > 0) || !std::isfinite(least)) return 1.0;
  return std::scalbn(1.0, std::clamp(-std::ilogb(least) - 1, -1000, 1000));
}

/// Identity of a triangle in the scene.
struct TrianglePlace {
  std::int32_t face = kNoFace;
  std::int32_t number = 0;
  double reach = 0;  ///< of the scene
};

/// Returns edge2 x edge1.
inline vec3<long double> back_of(const vec3<double>& edge1, const vec3<double>& edge2) {
  return cn::cross(vec3<long double>{edge2.x, edge2.y, edge2.z},
                   vec3<long double>{edge1.x, edge1.y, edge1.z});
}

/// Makes the record. The cross product is computed in extended precision, because in long thin triangles most
/// of its digits cancel; it is made only once.
inline TriangleRecord triangle_record(const vec3<double>& vertex, const vec3<double>& edge1,
                                      const vec3<double>& edge2, const TrianglePlace& place) {
  const double scale = record_scale(vertex, edge1, edge2, place.reach);
  const vec3<long double> back = back_of(edge1, edge2) * static_cast<long double>(scale);
  return {vertex,     edge1 * scale, edge2 * scale, {double(back.x), double(back.y), double(back.z)},
          place.face, place.number};
}

}  // namespace path_tracer
