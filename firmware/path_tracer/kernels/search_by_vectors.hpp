#pragma once

#include <utility>

#include "firmware/cn/language/mask4.hpp"
#include "firmware/path_tracer/geometry/triangle.hpp"
#include "firmware/path_tracer/kernels/resident_kernels.hpp"

/// The search for four rays of a PE at once, by vector instructions: what search() finds, to the bit, because
/// each element takes the steps of Crossing in their order.
///
/// A vector of four doubles is a quarter of a PE's registers. So rays, and what the test needs twice, lie in
/// SRAM; every load and store is charged. Most of the time is the path to SRAM, 4 bytes a cycle: the adder
/// and the multiplier wait for it.
///
/// Triangles that share their vertex with the one before, as the two halves of a quadrilateral do, share the
/// vector to it and its moment. The control unit sees that from their records.
namespace path_tracer {

using cn::mask4;
using cn::poly4;

/// Four rays as vectors.
class RayVectors {
 public:
  RayVectors(const PolyPointer<ResidentRay>& first, const cn::PolySpan& vectors)
      : first_(first), vector_(vectors.offset_bytes / 8) {}

  PolyPointer<ResidentRay> ray(int element) const {
    return PolyPointer<ResidentRay>(first_.span().offset_bytes + element * int{sizeof(ResidentPath)});
  }

  /// Computes the vectors from a vertex to the origins, and the moments: direction x vector to the vertex.
  void move_to(const vec3<double>& vertex) const {
    const double of_vertex[] = {vertex.x, vertex.y, vertex.z};
    for (int axis = 0; axis < kAxes; ++axis)
      store(kFromVertex + axis, load(&ResidentRay::origin, axis) - of_vertex[axis]);
    for (int axis = 0; axis < kAxes; ++axis) {
      const int next = (axis + 1) % kAxes;
      const int last = (axis + 2) % kAxes;
      const poly4<double> subtrahend = load(&ResidentRay::direction, next) * load(kFromVertex + last);
      store(kMoment + axis,
            cn::multiply_subtract(load(&ResidentRay::direction, last), load(kFromVertex + next), subtrahend));
    }
  }

  poly4<double> dot_direction(const vec3<double>& a) const {
    return dot(a, [&](int axis) { return load(&ResidentRay::direction, axis); });
  }
  poly4<double> dot_from_vertex(const vec3<double>& a) const {
    return dot(a, [&](int axis) { return load(kFromVertex + axis); });
  }
  /// Returns the moments' products with two vectors, for which they are loaded once.
  std::pair<poly4<double>, poly4<double>> dot_moment(const vec3<double>& a, const vec3<double>& b) const {
    const poly4<double> x = load(kMoment);
    poly4<double> of_a = x * a.x;
    poly4<double> of_b = x * b.x;
    const auto add = [&](int axis, double from_a, double from_b) {
      const poly4<double> component = load(kMoment + axis);
      of_a.assign_all_lanes(cn::multiply_add(component, from_a, of_a));
      of_b.assign_all_lanes(cn::multiply_add(component, from_b, of_b));
    };
    add(1, a.y, b.y);
    add(2, a.z, b.z);
    return {of_a, of_b};
  }

  poly4<double> load(double ResidentRay::*field) const { return load_at(first_.field(field).offset_bytes); }

 private:
  static constexpr int kAxes = 3;
  static constexpr int kFromVertex = 0;
  static constexpr int kMoment = 3;

  poly4<double> load(int vector) const { return sram_.load(cn::four_from(vector_ + 4 * vector)); }
  void store(int vector, const poly4<double>& value) const {
    sram_.store(cn::four_from(vector_ + 4 * vector), value);
  }
  poly4<double> load(vec3<double> ResidentRay::*field, int axis) const {
    return load_at(first_.field(field).offset_bytes + 8 * axis);
  }
  poly4<double> load_at(int offset_bytes) const {
    constexpr int kStride = int{sizeof(ResidentPath)} / 8;
    const int at = offset_bytes / 8;
    return sram_.load({at, at + kStride, at + 2 * kStride, at + 3 * kStride});
  }
  /// @param load gives a component of the other vector
  template <class Load>
  static poly4<double> dot(const vec3<double>& a, const Load& load) {
    const poly4<double> x = load(0) * a.x;
    const poly4<double> y = cn::multiply_add(load(1), a.y, x);
    return cn::multiply_add(load(2), a.z, y);
  }

  PolyPointer<ResidentRay> first_;
  cn::PolyArray<double> sram_{cn::PolySpan{}};
  int vector_;
};
static_assert(sizeof(ResidentPath) % 8 == 0);

/// Whether the control unit need not move to the triangle's vertex: it is that of the triangle before.
inline bool shares_vertex(const MonoTriangles& triangles, int i) {
  if (i == 0) return false;
  const vec3<double>& a = triangles(i - 1).vertex;
  const vec3<double>& b = triangles(i).vertex;
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

/// Tests one triangle. Returns the rays for which it is as near as the nearest so far. Its numbers are those
/// of Crossing, but for the sign of the distance. At most three vectors are alive besides an operand that is
/// being loaded: what a PE has registers for.
/// @param wanted rays that are searched for
inline mask4 test_by_vectors(const RayVectors& rays, const TriangleRecord& triangle, const mask4& wanted) {
  const poly4<double> determinant = rays.dot_direction(triangle.back);
  const auto [along_edge2, along_edge1] = rays.dot_moment(triangle.edge2, triangle.edge1);
  const poly4<double> u = cn::flip_sign(along_edge2, determinant);
  const poly4<double> minus_v = cn::flip_sign(along_edge1, determinant);
  const poly4<double> size = cn::abs(determinant);
  const mask4 within = (u >= 0.0) & (minus_v <= 0.0) & (u - minus_v <= size);
  const poly4<double> behind = cn::flip_sign(rays.dot_from_vertex(triangle.back), determinant);
  const mask4 inside = within & (behind < 0.0);

  const poly4<double> distance = cn::abs(behind);
  const poly4<double> left = distance * cn::abs(rays.load(&ResidentRay::determinant));
  const poly4<double> right = rays.load(&ResidentRay::distance) * size;
  const mask4 as_near = left == right;
  const mask4 nearer = left < right;
  mask4 tied;
  for (int i = 0; i < 4; ++i) {
    const PolyPointer<ResidentRay> ray = rays.ray(i);
    const mask leaves = ray.get(&ResidentRay::left_face) != poly<std::int32_t>(triangle.face);
    const mask candidate = inside[std::size_t(i)] & leaves & wanted[std::size_t(i)];
    tied[std::size_t(i)] = candidate & as_near[std::size_t(i)];
    cn::poly_if(candidate & nearer[std::size_t(i)], [&] {
      ray.set(&ResidentRay::distance, distance[i]);
      ray.set(&ResidentRay::determinant, determinant[i]);
      ray.set(&ResidentRay::number, poly<std::int32_t>(triangle.number));
    });
  }
  return tied;
}

/// Finds for each ray the nearest triangle. Returns the rays for which two were too close to tell which is
/// nearer.
inline mask4 search_by_vectors(const RayVectors& rays, const MonoTriangles& triangles, const mask4& wanted) {
  const mask none(cn::mask_from_bits(0));
  mask4 tied{none, none, none, none};
  for (int i = 0; i < triangles.count; ++i) {
    const TriangleRecord& triangle = triangles(i);
    cn::issue(cn::InstructionClass::mono, 8);  // the loop, and whether the vertex is another
    if (!shares_vertex(triangles, i)) rays.move_to(triangle.vertex);
    tied = tied | test_by_vectors(rays, triangle, wanted);
  }
  return tied;
}

}  // namespace path_tracer
