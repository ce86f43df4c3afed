#pragma once

#include <array>
#include <functional>
#include <numeric>

#include "firmware/cn/chip/mono_memory.hpp"

namespace cn {

/// Returns the union of the bits set in the PEs' offsets from `places.first`. It is at least as large as each
/// offset, and a multiple of 2^k only if each is. If a check passes on it, the PEs' offsets need not be
/// checked one by one.
inline std::uint64_t offset_bits(const MonoPlaces& places, int num_pes) {
  std::array<std::uint64_t, kStripLanes> of_lane{};
  for (int first_pe = 0; first_pe < num_pes; first_pe += kStripLanes) {
    const MonoAddress* const offsets = places.strip(first_pe);
    for (std::size_t lane = 0; lane < of_lane.size(); ++lane) of_lane[lane] |= offsets[lane];
  }
  return std::accumulate(of_lane.begin(), of_lane.end(), std::uint64_t{0}, std::bit_or<>());
}

}  // namespace cn
