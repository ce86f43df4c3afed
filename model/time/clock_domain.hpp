#pragma once

#include <cstdint>
#include <systemc>

#include "model/time/cycles.hpp"

namespace model {

/// Converts between chip cycles and SystemC's picoseconds, always from time zero, so rounding never
/// accumulates.
class ClockDomain {
 public:
  explicit ClockDomain(double clock_hz)
      : picoseconds_per_cycle_(1e12 / clock_hz), cycles_per_picosecond_(clock_hz / 1e12) {}

  sc_core::sc_time time_at(Cycles cycle) const {
    return sc_core::sc_time::from_value(nearest(double(cycle) * picoseconds_per_cycle_));
  }
  /// The cycle nearest to `time`.
  Cycles cycle_at(const sc_core::sc_time& time) const {
    return nearest(double(time.value()) * cycles_per_picosecond_);
  }

 private:
  /// Rounds by an addition: std::llround is a call, and this runs ten times a transfer. Good up to 2^52 ps,
  /// 75 minutes of simulated time; beyond that a double cannot hold half a picosecond anyway.
  static std::uint64_t nearest(double number) {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(number + 0.5));
  }

  double picoseconds_per_cycle_;  // SystemC's default resolution is 1 ps
  double cycles_per_picosecond_;
};

}  // namespace model
