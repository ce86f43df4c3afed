#pragma once

#include <cstdint>

#include "firmware/cn/chip/mono_memory.hpp"

namespace cn {

/// A run of bytes in mono memory.
struct MonoRange {
  MonoAddress first = 0;
  std::uint64_t bytes = 0;

  /// Whether all of `wanted` bytes from `address` on lie within.
  bool contains(MonoAddress address, std::uint64_t wanted) const {
    return address >= first && address - first <= bytes && wanted <= bytes - (address - first);
  }
};

}  // namespace cn
