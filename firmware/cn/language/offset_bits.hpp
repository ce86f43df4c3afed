#pragma once

#include <array>
#include <functional>
#include <numeric>

#include "firmware/cn/chip/transfer.hpp"

namespace cn {

/// Returns the union of the bits set in the enabled PEs' offsets from the transfer's first place. It is a
/// multiple of 2^k only if each offset is. If a check passes on it, the PEs' offsets need not be checked one
/// by one.
inline std::uint64_t offset_bits(const Transfer& transfer, int num_pes) {
  using transfer_detail::kHalf;
  std::array<std::uint64_t, kHalf> of_lane{};
  for (int first_pe = 0; first_pe < num_pes; first_pe += kStripLanes) {
    const unsigned bits = transfer.enabled.strip_bits(first_pe / kStripLanes);
    if (bits == 0) continue;
    const MonoAddress* const offsets = transfer.mono.strip(first_pe);
    for (unsigned half = 0; half < 2; ++half) {
      const auto& enabled = transfer_detail::kWordsOfBits[bits >> (half * kHalf) & ((1u << kHalf) - 1)];
      for (std::size_t i = 0; i < kHalf; ++i) of_lane[i] |= offsets[half * kHalf + i] & enabled[i];
    }
  }
  return std::accumulate(of_lane.begin(), of_lane.end(), std::uint64_t{0}, std::bit_or<>());
}

}  // namespace cn
