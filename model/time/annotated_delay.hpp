#pragma once

#include <systemc>

#include "model/time/clock_domain.hpp"

namespace model {

/// The cycle that a TLM-2.0 delay, counted from sc_time_stamp(), points at.
inline Cycles cycle_of_delay(const ClockDomain& clock, const sc_core::sc_time& delay) {
  return clock.cycle_at(sc_core::sc_time_stamp() + delay);
}

/// The delay that points at `cycle`; zero for one that is over, because delays cannot be negative.
inline sc_core::sc_time delay_until(const ClockDomain& clock, Cycles cycle) {
  const sc_core::sc_time time = clock.time_at(cycle);
  const sc_core::sc_time& now = sc_core::sc_time_stamp();
  return time > now ? time - now : sc_core::SC_ZERO_TIME;
}

}  // namespace model
