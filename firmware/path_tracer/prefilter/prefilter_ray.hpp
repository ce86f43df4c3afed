#pragma once

#include <array>
#include <cstdint>

#include "firmware/path_tracer/geometry/triangle.hpp"
#include "firmware/path_tracer/prefilter/prefilter.hpp"

namespace path_tracer {

namespace prefilter_detail {

using Floats = cn::Lanes<float>;
using FloatChunk = Floats::Chunk;
using Bits __attribute__((vector_size(sizeof(FloatChunk)))) = std::int32_t;

inline FloatChunk same(float value) {
  return value - FloatChunk{};
}
inline Bits same_bits(std::int32_t value) {
  return value - Bits{};
}

/// a * b + c, rounded once or twice.
inline FloatChunk multiply_add(FloatChunk a, FloatChunk b, FloatChunk c) {
#if defined(__FMA__)
  return FloatChunk(_mm256_fmadd_ps(__m256(a), __m256(b), __m256(c)));
#else
  return a * b + c;
#endif
}
/// c - a * b
inline FloatChunk subtract_product(FloatChunk a, FloatChunk b, FloatChunk c) {
#if defined(__FMA__)
  return FloatChunk(_mm256_fnmadd_ps(__m256(a), __m256(b), __m256(c)));
#else
  return c - a * b;
#endif
}

struct Vector {
  FloatChunk x;
  FloatChunk y;
  FloatChunk z;
};

inline Vector same(const std::array<float, 3>& v) {
  return {same(v[0]), same(v[1]), same(v[2])};
}
inline FloatChunk dot(const Vector& a, const Vector& b) {
  return multiply_add(a.z, b.z, multiply_add(a.y, b.y, a.x * b.x));
}
inline Vector cross(const Vector& a, const Vector& b) {
  return {subtract_product(a.z, b.y, a.y * b.z), subtract_product(a.x, b.z, a.z * b.x),
          subtract_product(a.y, b.x, a.x * b.y)};
}

/// For operands without NaN, where x86-64 has one instruction.
inline FloatChunk lesser(FloatChunk a, FloatChunk b) {
#if defined(__AVX2__)
  return FloatChunk(_mm256_min_ps(__m256(a), __m256(b)));
#else
  return FloatChunk(_mm_min_ps(__m128(a), __m128(b)));
#endif
}
inline FloatChunk greater(FloatChunk a, FloatChunk b) {
#if defined(__AVX2__)
  return FloatChunk(_mm256_max_ps(__m256(a), __m256(b)));
#else
  return FloatChunk(_mm_max_ps(__m128(a), __m128(b)));
#endif
}

inline unsigned signs(FloatChunk a) {
#if defined(__AVX2__)
  return unsigned(_mm256_movemask_ps(__m256(a)));
#else
  return unsigned(_mm_movemask_ps(__m128(a)));
#endif
}

constexpr int kLanesOfChunk = int{sizeof(FloatChunk) / sizeof(float)};

/// Reorders bits of lanes to the order of floats (place_of_lane).
inline unsigned in_order_of_floats(unsigned lanes) {
  unsigned places = 0;
  for (int lane = 0; lane < cn::kStripLanes; ++lane)
    places |= (lanes >> lane & 1u) << cn::place_of_lane<float>(lane);
  return places;
}

}  // namespace prefilter_detail

/// A strip's rays in single precision; they tell which triangles they may cross.
///
/// Errors, with u = 2^-24: coordinates are below 2 and have an error of 2 u; vectors from a ray's origin to a
/// vertex have 6 u. Directions are below 1.5, edges below 1, `back` below 4. So the barycentric numerators u
/// and v (triangle.hpp), whose terms are below 6, are known to 162 u, the determinant to 90 u, the distance
/// to 190 u, and u + v - |determinant| to 450 u. The margin is 512 u. A determinant within the margin may
/// have either sign; such a ray may cross.
class PrefilterRay {
 public:
  PrefilterRay(const RayOperands& ray, const Prefilter& prefilter) {
    const poly<double> largest =
        cn::max(cn::max(cn::abs(ray.direction.x), cn::abs(ray.direction.y)), cn::abs(ray.direction.z));
    const poly<double> scale = cn::inverse_power_of_two(cn::nearest_power_of_two(largest));
    set(origin_, (ray.origin - prefilter.anchor) * prefilter.unit);
    set(direction_, ray.direction * scale);
    left_face_ =
        cn::halves_of_words<cn::WordHalf::low>(cn::bit_cast_lanes<std::uint64_t>(ray.left_face.lanes()));
  }

  /// Returns the lanes that may cross the triangle, in the order of floats.
  unsigned may_cross(const PrefilterTriangle& triangle) const {
    unsigned lanes = 0;
    for (int i = 0; i < prefilter_detail::Floats::kChunks; ++i)
      lanes |= may_cross(triangle, i) << (i * prefilter_detail::kLanesOfChunk);
    return lanes;
  }

 private:
  static constexpr float kMargin = 0x1p-15f;
  using Vector = prefilter_detail::Vector;

  void set(Vector (&to)[prefilter_detail::Floats::kChunks], const vec3<poly<double>>& from) {
    const auto x = cn::narrow_lanes(from.x.lanes());
    const auto y = cn::narrow_lanes(from.y.lanes());
    const auto z = cn::narrow_lanes(from.z.lanes());
    for (int i = 0; i < prefilter_detail::Floats::kChunks; ++i) to[i] = {x.chunk[i], y.chunk[i], z.chunk[i]};
  }

  unsigned may_cross(const PrefilterTriangle& triangle, int i) const {
    using prefilter_detail::Bits;
    using prefilter_detail::FloatChunk;
    using prefilter_detail::greater;
    using prefilter_detail::lesser;
    using prefilter_detail::same;
    using prefilter_detail::same_bits;
    using prefilter_detail::signs;
    const Vector vertex = same(triangle.vertex);
    const Vector to_vertex{vertex.x - origin_[i].x, vertex.y - origin_[i].y, vertex.z - origin_[i].z};
    const Vector back = same(triangle.back);
    const Vector moment = cross(direction_[i], to_vertex);
    const FloatChunk determinant = dot(direction_[i], back);
    const Bits sign = Bits(determinant) & same_bits(INT32_MIN);
    const FloatChunk size = FloatChunk(Bits(determinant) ^ sign);
    const FloatChunk minus_size = FloatChunk(Bits(determinant) | same_bits(INT32_MIN));
    const auto signed_by = [&](FloatChunk a) { return FloatChunk(Bits(a) ^ sign); };
    const FloatChunk distance = signed_by(dot(to_vertex, back));
    const FloatChunk u = signed_by(dot(moment, same(triangle.edge2)));
    const FloatChunk v = signed_by(dot(moment, same(triangle.minus_edge1)));
    const FloatChunk within = lesser(lesser(u, v), lesser(size - (u + v), distance));
    // Negative where the ray misses for certain.
    const FloatChunk crossing = greater(within, minus_size) + same(kMargin);
    const Bits leaves = Bits(left_face_.chunk[i]) == same_bits(triangle.face);
    return ~signs(FloatChunk(Bits(crossing) | leaves)) & ((1u << prefilter_detail::kLanesOfChunk) - 1);
  }

  Vector origin_[prefilter_detail::Floats::kChunks];
  Vector direction_[prefilter_detail::Floats::kChunks];
  prefilter_detail::Floats left_face_;
};

}  // namespace path_tracer
