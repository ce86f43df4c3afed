#pragma once

#include <cstdint>

#include "model/time/cycles.hpp"

namespace model {

/// Cycles by which programmed I/O lengthens a kernel. Each word that the engine moves takes one PE's SRAM
/// port for `stolen_cycles_per_word`; the PEs run in lock step, so all of them lose those cycles, but only
/// where the kernel accesses SRAM too: with its accesses spread evenly, that is in sram_cycles of its
/// kernel_cycles. Rounded to the nearest. (docs/csx600.md, section 2: 1 SRAM cycle per 8 bytes, compute wins
/// otherwise.)
/// @param words 8-byte words that the engine moves, in all PEs, while the kernel runs
constexpr Cycles stolen_cycles(std::uint64_t words, int stolen_cycles_per_word, Cycles sram_cycles,
                               Cycles kernel_cycles) {
  if (kernel_cycles == 0) return 0;
  return (words * std::uint64_t(stolen_cycles_per_word) * sram_cycles + kernel_cycles / 2) / kernel_cycles;
}

}  // namespace model
