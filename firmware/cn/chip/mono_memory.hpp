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

/// Where each PE's piece of a transfer lies in mono memory. Every PE supplies its own address; an array that
/// is laid out by PE number is described by its start instead of by num_pes addresses.
struct MonoPlaces {
  MonoAddress first = 0;
  std::uint64_t stride_bytes = 0;
  const MonoAddress* by_pe =
      nullptr;  ///< when set, addresses relative to `first`, a strip's side by side; no stride then
  std::size_t to_next_strip = kStripLanes;  ///< addresses, from one strip's to the next's

  static MonoPlaces array(MonoAddress first, std::uint64_t stride_bytes) { return {first, stride_bytes}; }
  static MonoPlaces each(const MonoAddress* by_pe, std::uint64_t offset_bytes = 0,
                         std::size_t to_next_strip = kStripLanes) {
    return {offset_bytes, 0, by_pe, to_next_strip};
  }

  /// With `by_pe`: the addresses of the strip that PE `first_pe` begins.
  const MonoAddress* strip(int first_pe) const {
    return by_pe + std::size_t(first_pe / kStripLanes) * to_next_strip;
  }

  MonoAddress operator[](int pe) const {
    return first + (by_pe != nullptr ? strip(pe)[pe % kStripLanes] : std::uint64_t(pe) * stride_bytes);
  }
};

}  // namespace cn
