#pragma once

#include <array>
#include <cstdint>
#include <cstring>

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

inline FloatChunk without_sign(FloatChunk a) {
  return FloatChunk(Bits(a) & same_bits(INT32_MAX));
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
constexpr unsigned kAllOfChunk = (1u << kLanesOfChunk) - 1;

inline FloatChunk chunk_at(const float* from) {
  FloatChunk chunk;
  std::memcpy(&chunk, from, sizeof(chunk));
  return chunk;
}

/// Crossing (geometry/triangle.hpp) in single precision: rays with triangles, one each.
struct FloatCrossing {
  FloatChunk size;        ///< of the determinant
  FloatChunk minus_size;  ///< of the determinant
  FloatChunk distance;    ///< as the other numbers, times the determinant
  FloatChunk u;
  FloatChunk v;

  FloatCrossing(const Vector& direction, const Vector& to_vertex, const Vector& back,
                const Vector& minus_edge1, const Vector& edge2) {
    const Vector moment = cross(direction, to_vertex);
    const FloatChunk determinant = dot(direction, back);
    const Bits sign = Bits(determinant) & same_bits(INT32_MIN);
    const auto signed_by = [&](FloatChunk a) { return FloatChunk(Bits(a) ^ sign); };
    size = signed_by(determinant);
    minus_size = FloatChunk(Bits(determinant) | same_bits(INT32_MIN));
    distance = signed_by(dot(to_vertex, back));
    u = signed_by(dot(moment, edge2));
    v = signed_by(dot(moment, minus_edge1));
  }
  /// The least of what must not be negative.
  FloatChunk within() const { return lesser(lesser(u, v), lesser(size - (u + v), distance)); }
};

/// Reorders bits of lanes to the order of floats (place_of_lane).
inline unsigned in_order_of_floats(unsigned lanes) {
  unsigned places = 0;
  for (int lane = 0; lane < cn::kStripLanes; ++lane)
    places |= (lanes >> lane & 1u) << cn::place_of_lane<float>(lane);
  return places;
}

}  // namespace prefilter_detail

/// Errors of FloatCrossing, with u = 2^-24: coordinates are below 2 and have an error of 2 u; vectors from a
/// ray's origin to a vertex have 6 u. Directions are below 1.5, edges below 1, `back` below 4. So the
/// barycentric numerators u and v (triangle.hpp), whose terms are below 6, are known to 162 u, the
/// determinant to 90 u, the distance to 190 u, and u + v - |determinant| to 450 u. The margin is 512 u. A
/// determinant within the margin may have either sign; such a ray may cross.
inline constexpr float kPrefilterMargin = 0x1p-15f;

/// What is known of crossings in single precision.
struct CrossingBounds {
  unsigned may;      ///< bit i: the i-th may be one
  unsigned certain;  ///< bit i: the i-th is one, in the triangle's padded box, if it may be one
  // Distances along the scaled direction, in the prefilter's unit:
  prefilter_detail::FloatChunk earliest;
  prefilter_detail::FloatChunk latest;  ///< of certain ones

  static constexpr float kEarlier = 1 - 0x1p-20f;
  static constexpr float kLater = 1 + 0x1p-20f;

  /// Sets `may` alone.
  CrossingBounds(const prefilter_detail::FloatCrossing& at, const prefilter_detail::Bits& ignored) {
    using namespace prefilter_detail;
    // Negative where the ray misses for certain.
    const FloatChunk crossing = greater(at.within(), at.minus_size) + same(kPrefilterMargin);
    may = ~signs(FloatChunk(Bits(crossing) | ignored)) & kAllOfChunk;
  }
  /// @param certain_size of the determinant, from which on a crossing is in the padded box
  void set_others(const prefilter_detail::FloatCrossing& at,
                  const prefilter_detail::FloatChunk& certain_size) {
    using namespace prefilter_detail;
    const FloatChunk margin = same(kPrefilterMargin);
    const FloatChunk least = at.size - margin;
    earliest = (at.distance - margin) / (at.size + margin) * kEarlier;
    latest = (at.distance + margin) / least * kLater;
    certain = ~(signs(at.within() - margin) | signs(least - certain_size)) & kAllOfChunk;
  }
};

/// A strip's rays in single precision; they tell which triangles they may cross.
class PrefilterRay {
 public:
  PrefilterRay(const RayOperands& ray, const Prefilter& prefilter)
      : PrefilterRay(ray, prefilter.anchor, prefilter.unit) {}
  PrefilterRay(const RayOperands& ray, const vec3<double>& anchor, double unit) {
    const poly<double> largest =
        cn::max(cn::max(cn::abs(ray.direction.x), cn::abs(ray.direction.y)), cn::abs(ray.direction.z));
    scale_.assign_all_lanes(cn::inverse_power_of_two(cn::nearest_power_of_two(largest)));
    set(origin_, (ray.origin - anchor) * unit);
    set(direction_, ray.direction * scale_);
    left_face_ =
        cn::halves_of_words<cn::WordHalf::low>(cn::bit_cast_lanes<std::uint64_t>(ray.left_face.lanes()));
  }

  /// Returns the lanes that may cross the triangle, in the order of floats.
  unsigned may_cross(const PrefilterTriangle& triangle) const {
    unsigned lanes = 0;
    for (int i = 0; i < prefilter_detail::Floats::kChunks; ++i)
      lanes |= CrossingBounds(crossing(triangle, i), leaves(triangle, i)).may
               << (i * prefilter_detail::kLanesOfChunk);
    return lanes;
  }

  /// @param i number of the chunk, as of Lanes<float>
  prefilter_detail::FloatCrossing crossing(const PrefilterTriangle& triangle, int i) const {
    using prefilter_detail::same;
    const Vector vertex = same(triangle.vertex);
    const Vector to_vertex{vertex.x - origin_[i].x, vertex.y - origin_[i].y, vertex.z - origin_[i].z};
    return {direction_[i], to_vertex, same(triangle.back), same(triangle.minus_edge1), same(triangle.edge2)};
  }
  /// All ones where the ray leaves the triangle's face.
  prefilter_detail::Bits leaves(const PrefilterTriangle& triangle, int i) const {
    return prefilter_detail::Bits(left_face_.chunk[i]) == prefilter_detail::same_bits(triangle.face);
  }

  /// The sum of the components of each scaled direction, or a little more.
  prefilter_detail::FloatChunk length_bound(int i) const {
    using prefilter_detail::without_sign;
    const Vector& direction = direction_[i];
    return (without_sign(direction.x) + without_sign(direction.y) + without_sign(direction.z)) *
           CrossingBounds::kLater;
  }
  /// Of the directions, a power of two.
  const poly<double>& scale() const { return scale_; }
  /// The ray of a lane.
  std::array<float, 3> origin(int lane) const { return vector(origin_, lane); }
  std::array<float, 3> direction(int lane) const { return vector(direction_, lane); }

 private:
  using Vector = prefilter_detail::Vector;

  void set(Vector (&to)[prefilter_detail::Floats::kChunks], const vec3<poly<double>>& from) {
    const auto x = cn::narrow_lanes(from.x.lanes());
    const auto y = cn::narrow_lanes(from.y.lanes());
    const auto z = cn::narrow_lanes(from.z.lanes());
    for (int i = 0; i < prefilter_detail::Floats::kChunks; ++i) to[i] = {x.chunk[i], y.chunk[i], z.chunk[i]};
  }

  static std::array<float, 3> vector(const Vector (&of)[prefilter_detail::Floats::kChunks], int lane) {
    const int place = cn::place_of_lane<float>(lane);
    const Vector& chunk = of[place / prefilter_detail::kLanesOfChunk];
    const int i = place % prefilter_detail::kLanesOfChunk;
    return {chunk.x[i], chunk.y[i], chunk.z[i]};
  }

  poly<double> scale_;
  Vector origin_[prefilter_detail::Floats::kChunks];
  Vector direction_[prefilter_detail::Floats::kChunks];
  prefilter_detail::Floats left_face_;
};

}  // namespace path_tracer
