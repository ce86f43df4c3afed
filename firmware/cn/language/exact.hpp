#pragma once

#include "firmware/cn/language/math.hpp"

/// Exact rounding errors, and powers of two.
namespace cn {

namespace exact_detail {

struct Halves {
  poly<double> high;
  poly<double> low;
};

/// Splits into two halves of 26 bits (Dekker, "A Floating-Point Technique for Extending the Available
/// Precision", 1971).
inline Halves split(const poly<double>& a) {
  const poly<double> c = a * 134217729.0;  // 2^27 + 1
  const poly<double> high = c - (c - a);
  return {high, a - high};
}

}  // namespace exact_detail

/// Returns a * b - product exactly. `product` is a * b rounded; nothing may overflow or underflow.
inline poly<double> product_error(const poly<double>& a, const poly<double>& b, const poly<double>& product) {
  const exact_detail::Halves p = exact_detail::split(a);
  const exact_detail::Halves q = exact_detail::split(b);
  return (p.high * q.high - product) + p.high * q.low + p.low * q.high + p.low * q.low;
}

/// Returns the power of two nearest to a positive number, by its exponent.
inline poly<double> nearest_power_of_two(const poly<double>& a) {
  constexpr std::uint64_t kExponent = 0x7ff0000000000000u;
  const poly<std::uint64_t> bits = reinterpret<std::uint64_t>(a * 1.4142135623730951);
  return reinterpret<double>(bits & poly<std::uint64_t>(kExponent));
}

/// Returns 1 / a exactly; `a` is a power of two.
inline poly<double> inverse_power_of_two(const poly<double>& a) {
  constexpr std::uint64_t kTwiceBias = 2046;
  return reinterpret<double>((kTwiceBias << 52) - reinterpret<std::uint64_t>(a));
}

/// Returns the upper or lower 32 bits. Naming half of a register costs nothing.
template <class T>
inline poly<std::uint32_t> high_word(const poly<T>& a) {
  const auto bits = bit_cast_lanes<std::uint64_t>(a.lanes());
  return poly<std::uint32_t>(each_chunk<std::uint64_t>([&](int i) { return bits.chunk[i] >> 32; }));
}
template <class T>
inline poly<std::uint32_t> low_word(const poly<T>& a) {
  return poly<std::uint32_t>(wrap_lanes<std::uint32_t>(bit_cast_lanes<std::uint64_t>(a.lanes())));
}

}  // namespace cn
