#pragma once

#include <array>
#include <cstdint>

#include "firmware/cn/simd/lanes.hpp"

namespace cn {

inline constexpr int kMaxPes = 1024;

/// One enable bit for each PE of the array, by strips: bit i of byte s is PE s * kStripLanes + i.
class LaneMask {
 public:
  LaneMask() = default;

  /// The first `count` PEs.
  static LaneMask first(int count) {
    LaneMask mask;
    for (int pe = 0; pe < count; ++pe) mask.set(pe, true);
    return mask;
  }

  bool operator[](int pe) const { return (strips_[pe / kStripLanes] >> (pe % kStripLanes)) & 1; }
  void set(int pe, bool enabled) {
    const auto bit = static_cast<std::uint8_t>(1u << (pe % kStripLanes));
    std::uint8_t& bits = strips_[pe / kStripLanes];
    bits = static_cast<std::uint8_t>(enabled ? bits | bit : bits & ~bit);
  }

  std::uint8_t strip_bits(int strip_index) const { return strips_[strip_index]; }
  void set_strip_bits(int strip_index, std::uint32_t bits) {
    strips_[strip_index] = static_cast<std::uint8_t>(bits);
  }

  int count() const {
    int sum = 0;
    for (std::size_t i = 0; i < strips_.size(); i += sizeof(std::uint64_t)) {
      std::uint64_t word;
      __builtin_memcpy(&word, &strips_[i], sizeof(word));
      sum += __builtin_popcountll(word);
    }
    return sum;
  }
  bool any() const { return count() != 0; }

  LaneMask with(const LaneMask& other) const {
    LaneMask both;
    for (std::size_t i = 0; i < strips_.size(); ++i)
      both.strips_[i] = static_cast<std::uint8_t>(strips_[i] | other.strips_[i]);
    return both;
  }
  LaneMask without(const LaneMask& other) const {
    LaneMask rest;
    for (std::size_t i = 0; i < strips_.size(); ++i)
      rest.strips_[i] = static_cast<std::uint8_t>(strips_[i] & ~other.strips_[i]);
    return rest;
  }

  bool operator==(const LaneMask& other) const { return strips_ == other.strips_; }

 private:
  static_assert(kStripLanes == 8);
  std::array<std::uint8_t, kMaxPes / kStripLanes> strips_{};
};

}  // namespace cn
