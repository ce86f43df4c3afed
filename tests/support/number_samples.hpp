#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <type_traits>
#include <vector>

namespace test_support {

template <class T>
std::vector<T> extremes() {
  using Limits = std::numeric_limits<T>;
  if constexpr (std::is_floating_point_v<T>) {
    const T inf = Limits::infinity();
    return {T(0),
            -T(0),
            T(1),
            T(-1),
            T(1) + Limits::epsilon(),
            T(0.1),
            Limits::denorm_min(),
            -Limits::min(),
            Limits::max(),
            Limits::lowest(),
            inf,
            -inf,
            Limits::quiet_NaN()};
  } else {
    return {T(0),
            T(1),
            static_cast<T>(-1),
            T(2),
            T(0x5555),
            Limits::max(),
            Limits::min(),
            static_cast<T>(Limits::max() - 1),
            static_cast<T>(Limits::min() + 1)};
  }
}

template <class T>
T random_value(std::mt19937_64& random) {
  if constexpr (std::is_floating_point_v<T>) {
    const auto scale = static_cast<int>(random() % 80) - 40;
    return static_cast<T>(std::ldexp(static_cast<double>(static_cast<std::int64_t>(random())), scale - 63));
  } else {
    return static_cast<T>(random() >> (random() % 64));  // all magnitudes
  }
}

/// Pairs of all extreme values, then random pairs.
template <class T>
inline void fill_pairs(std::vector<T>& a, std::vector<T>& b) {
  const std::vector<T> values = extremes<T>();
  std::mt19937_64 random(11);
  for (std::size_t i = 0; i < a.size(); ++i) {
    const bool extreme = i < values.size() * values.size();
    a[i] = extreme ? values[i / values.size()] : random_value<T>(random);
    b[i] = extreme ? values[i % values.size()] : random_value<T>(random);
  }
}

template <class T>
inline bool same(T x, T y) {
  if constexpr (std::is_floating_point_v<T>) {
    if (std::isnan(x) && std::isnan(y)) return true;
  }
  return std::memcmp(&x, &y, sizeof(T)) == 0;
}

}  // namespace test_support
