#pragma once

#include <cstdint>

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
  const MonoAddress* by_pe = nullptr;  ///< when set, PE p's address relative to `first`; no stride then

  static MonoPlaces array(MonoAddress first, std::uint64_t stride_bytes) {
    return {first, stride_bytes, nullptr};
  }
  static MonoPlaces each(const MonoAddress* by_pe, std::uint64_t offset_bytes = 0) {
    return {offset_bytes, 0, by_pe};
  }

  MonoAddress operator[](int pe) const {
    return first + (by_pe != nullptr ? by_pe[pe] : std::uint64_t(pe) * stride_bytes);
  }
};

}  // namespace cn
