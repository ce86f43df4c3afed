#pragma once

#include <cstdint>

namespace plug_in {

/// A pseudo-random number in [0, 1) that depends only on its index, as inputs that prepare() makes and
/// check() makes again need it: splitmix64 (Steele, Lea, Flood, 2014).
inline double random_of(std::uint64_t index) {
  std::uint64_t bits = (index + 1) * 0x9e3779b97f4a7c15u;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  bits ^= bits >> 31;
  return double(bits >> 11) * 0x1p-53;
}

}  // namespace plug_in
