#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace testbench {

/// A hash of coordinates that are compared exactly; 0 and -0 have different ones.
template <std::size_t count>
std::uint64_t hash_of_coordinates(const std::array<double, count>& coordinates) {
  std::uint64_t hash = 0;
  for (const double coordinate : coordinates) {
    std::uint64_t bits;
    std::memcpy(&bits, &coordinate, sizeof(bits));
    hash = (hash ^ bits) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return hash;
}

}  // namespace testbench
