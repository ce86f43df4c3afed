#pragma once

#include <array>
#include <cstdint>

#include "model/observe/control_observer.hpp"
#include "model/pe_array/kernel_statistics.hpp"
#include "model/time/cycles.hpp"

namespace model {

struct ControlStatistics {
  std::array<Cycles, kCycleCauses> cycles{};  ///< by cause; the sum is the run
  std::uint64_t mono_instructions = 0;
  std::uint64_t data_cache_hits = 0;
  std::uint64_t data_cache_misses = 0;
  std::uint64_t thread_switches = 0;

  Cycles operator[](CycleCause cause) const { return cycles[std::size_t(cause)]; }
  Cycles total() const;
  Cycles exposed_pio() const { return pio_waits().total(); }
  PioWaits pio_waits() const;
};

}  // namespace model
