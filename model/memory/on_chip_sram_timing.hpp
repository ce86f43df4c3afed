#pragma once

#include <cstdint>

#include "model/config/chip_config.hpp"
#include "model/observe/memory_observer.hpp"
#include "model/time/cycles.hpp"
#include "model/transaction/divisor.hpp"

namespace model {

struct OnChipSramStatistics {
  std::uint64_t accesses = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_written = 0;
  std::uint64_t busy_cycles = 0;  ///< cycles in which its port transfers
};

/// The timing of an SRAM with one port for reads and writes: accesses follow each other at `bytes_per_cycle`,
/// each begins with a word of its own, and `latency_cycles` are pipelined.
class OnChipSramTiming {
 public:
  struct Access {
    Cycles start;   ///< first byte at the port
    Cycles finish;  ///< after the last byte
  };

  explicit OnChipSramTiming(const ChipConfig::OnChipSram& config)
      : bytes_per_cycle_(std::uint64_t(config.bytes_per_cycle)),
        latency_cycles_(Cycles(config.latency_cycles)) {}

  Access access(std::uint64_t bytes, bool write, Cycles arrival);

  const OnChipSramStatistics& statistics() const { return statistics_; }
  void set_observer(OnChipSramObserver* observer) { observer_ = observer; }

 private:
  Divisor bytes_per_cycle_;
  Cycles latency_cycles_;
  Cycles port_free_ = 0;
  OnChipSramObserver* observer_ = nullptr;
  OnChipSramStatistics statistics_;
};

}  // namespace model
