#pragma once

#include <cmath>
#include <cstdint>
#include <systemc>

#include "model/cycles.hpp"

namespace model {

/// Between chip cycles and SystemC's picoseconds. Always converts from time zero, so rounding never
/// accumulates.
class ClockDomain {
 public:
  explicit ClockDomain(double clock_hz) : picoseconds_per_cycle_(1e12 / clock_hz) {}

  sc_core::sc_time time_at(Cycles cycle) const {
    return sc_core::sc_time::from_value(
        static_cast<sc_dt::uint64>(std::llround(double(cycle) * picoseconds_per_cycle_)));
  }
  /// The cycle nearest to `time`.
  Cycles cycle_at(const sc_core::sc_time& time) const {
    return static_cast<Cycles>(std::llround(double(time.value()) / picoseconds_per_cycle_));
  }

 private:
  double picoseconds_per_cycle_;  // SystemC's default resolution is 1 ps
};

}  // namespace model
