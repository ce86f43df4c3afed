#include "model/memory/on_chip_sram_timing.hpp"

#include <algorithm>

namespace model {

OnChipSramTiming::Access OnChipSramTiming::access(std::uint64_t bytes, bool write, Cycles arrival) {
  const Cycles cycles = bytes_per_cycle_.quotient(bytes + bytes_per_cycle_.value() - 1);
  const Cycles start = std::max(arrival + latency_cycles_, port_free_);
  port_free_ = start + cycles;
  ++statistics_.accesses;
  (write ? statistics_.bytes_written : statistics_.bytes_read) += bytes;
  statistics_.busy_cycles += cycles;
  if (observer_ != nullptr) observer_->sram_accessed(write, start, port_free_);
  return {start, port_free_};
}

}  // namespace model
