#pragma once

#include <cstdint>

#include "firmware/cn/chip/label.hpp"
#include "firmware/cn/chip/lane_mask.hpp"
#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/cn/chip/poly_memory.hpp"

namespace cn {

/// A hardware semaphore: a counter that PIO transfers, threads and the host signal and wait on.
struct Semaphore {
  int index = -1;
};

enum class Direction : std::uint8_t { mono_to_poly, poly_to_mono };

/// One programmed-I/O request: every enabled PE moves `poly.size_bytes` between its SRAM and its own place in
/// mono memory; `done` is signalled when all have.
struct Transfer {
  Direction direction = Direction::mono_to_poly;
  PolySpan poly;
  MonoPlaces mono;
  LaneMask enabled;
  Semaphore done;
  Label label{};
};

/// Returns the first enabled PE whose place is not `allowed(place)`, or -1.
template <class Allowed>
int first_pe_not(const Transfer& transfer, int num_pes, Allowed&& allowed) {
  for (int first_pe = 0; first_pe < num_pes; first_pe += kStripLanes) {
    const unsigned enabled = transfer.enabled.strip_bits(first_pe / kStripLanes);
    if (enabled == 0) continue;
    unsigned not_allowed = 0;
    for (int lane = 0; lane < kStripLanes; ++lane)
      not_allowed |= static_cast<unsigned>(!allowed(transfer.mono[first_pe + lane])) << lane;
    if ((not_allowed & enabled) != 0) return first_pe + __builtin_ctz(not_allowed & enabled);
  }
  return -1;
}

/// Moves the bytes of a transfer; `mono` is the storage of mono address 0. Addresses and sizes are multiples
/// of 8 (checked by Machine).
void move_data(const Transfer& transfer, PolyMemory& poly, std::uint8_t* mono);

}  // namespace cn
