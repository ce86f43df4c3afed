#pragma once

#include <cmath>

#include "firmware/cn/language/math.hpp"

/// What the code of a texel's channel stands for, on PEs and on the host alike. The host may so put a texel's
/// value where the PEs would look it up, and the result is the same to the bit.
namespace path_tracer {

namespace texel_detail {

/// On the host; PEs have cn::select.
inline double select(bool condition, double if_set, double otherwise) {
  return condition ? if_set : otherwise;
}

}  // namespace texel_detail

/// Value in [0, 1] of a code of 8 bits. @tparam Number double or poly<double>
template <class Number>
inline Number value_of_code(const Number& code) {
  return code * (1.0 / 255.0);
}

/// Linear value in [0, 1] of a code of the sRGB transfer curve (IEC 61966-2-1). Its power 2.4 is a polynomial
/// of the square root, fitted for the least relative error at all codes, then scaled so that no code shows
/// more than its value, which would add light. Relative error: 2.2e-7.
/// @tparam Number double or poly<double>
template <class Number>
inline Number linear_of_srgb(const Number& code) {
  using std::sqrt;
  using texel_detail::select;
  constexpr double kLastOfLine = 10.0;
  const Number root = sqrt(code * (1.0 / (255.0 * 1.055)) + 0.055 / 1.055);
  constexpr double kPower[] = {7.085407525661334e-05, -0.0012565798546192415, 0.01002360980055449,
                               -0.049690995429022576, 0.2085089705424304,     0.9098770613347521,
                               -0.0896015715319457,   0.012068650161608033};
  constexpr int kDegree = int{sizeof(kPower) / sizeof(kPower[0])} - 1;
  Number curve = kPower[kDegree];
  for (int i = kDegree - 1; i >= 0; --i) curve = curve * root + kPower[i];
  return select(code > kLastOfLine, curve, code * (1.0 / (255.0 * 12.92)));
}

}  // namespace path_tracer
