#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/cn/simd/lanes.hpp"

namespace cn {

/// A byte address in mono memory.
using MonoAddress = std::uint64_t;

/// A typed address in mono memory.
template <class T>
struct MonoPointer {
  MonoAddress address = 0;

  MonoPointer operator+(std::uint64_t index) const { return {address + index * sizeof(T)}; }
};

/// Where each PE's piece of a transfer lies in mono memory. Every PE supplies its own address. An array that
/// is ordered by PE number needs its start and stride only, instead of num_pes addresses.
struct MonoPlaces {
  MonoAddress first = 0;
  std::uint64_t stride_bytes = 0;
  const MonoAddress* by_pe =
      nullptr;  ///< if set: addresses relative to `first`, a strip's side by side; then there is no stride
  std::size_t to_next_strip = kStripLanes;  ///< stride between strips, in addresses

  static MonoPlaces array(MonoAddress first, std::uint64_t stride_bytes) { return {first, stride_bytes}; }
  static MonoPlaces each(const MonoAddress* by_pe, std::uint64_t offset_bytes = 0,
                         std::size_t to_next_strip = kStripLanes) {
    return {offset_bytes, 0, by_pe, to_next_strip};
  }

  /// The addresses of the strip that PE `first_pe` begins; with `by_pe` only.
  const MonoAddress* strip(int first_pe) const {
    return by_pe + std::size_t(first_pe / kStripLanes) * to_next_strip;
  }

  MonoAddress operator[](int pe) const {
    return first + (by_pe != nullptr ? strip(pe)[pe % kStripLanes] : std::uint64_t(pe) * stride_bytes);
  }
};

}  // namespace cn
