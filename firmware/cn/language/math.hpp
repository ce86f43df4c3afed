#pragma once

#include <cmath>

#include "firmware/cn/language/poly.hpp"

namespace cn {

template <class T>
inline poly<T> sqrt(const poly<T>& a) {
  static_assert(std::is_floating_point_v<T>);
  issue(std::is_same_v<T, double> ? InstructionClass::fp64_sqrt : InstructionClass::fp32_sqrt);
  return poly<T>(each_lane<T>([&](int i) { return std::sqrt(a.lanes()[i]); }));
}

template <class T>
inline poly<T> min(const poly<T>& a, const poly<T>& b) {
  return select(b < a, b, a);
}

template <class T>
inline poly<T> max(const poly<T>& a, const poly<T>& b) {
  return select(a < b, b, a);
}

/// Clears the sign bit, which is in one 16-bit word.
inline poly<double> abs(const poly<double>& a) {
  issue(InstructionClass::int16_alu);
  const auto bits = bit_cast_lanes<std::uint64_t>(a.lanes());
  constexpr std::uint64_t kAllButSign = ~(std::uint64_t{1} << 63);
  return poly<double>(
      bit_cast_lanes<double>(each_chunk<std::uint64_t>([&](int i) { return bits.chunk[i] & kAllButSign; })));
}

/// Returns `a` with its sign changed where `by` is negative.
inline poly<double> flip_sign(const poly<double>& a, const poly<double>& by) {
  issue(InstructionClass::int16_alu, 2);
  const auto bits = bit_cast_lanes<std::uint64_t>(a.lanes());
  const auto sign = bit_cast_lanes<std::uint64_t>(by.lanes());
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return poly<double>(bit_cast_lanes<double>(
      each_chunk<std::uint64_t>([&](int i) { return bits.chunk[i] ^ (sign.chunk[i] & kSign); })));
}

struct SineCosine {
  poly<double> sine;
  poly<double> cosine;
};

/// Computes both at once by SLEEF's bit-reproducible functions without fused multiply-add: the same bits at
/// every x86-64 level, with an error below 1 ulp.
SineCosine sincos(const poly<double>& radians);

/// Returns the angle of the point (x, y) from the positive x axis, in (-pi, pi].
poly<double> atan2(const poly<double>& y, const poly<double>& x);

poly<double> exp(const poly<double>& a);
poly<double> log(const poly<double>& a);

}  // namespace cn
