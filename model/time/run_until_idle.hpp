#pragma once

#include <systemc>

namespace model {

/// Runs the simulation until nothing is left to happen, a simulated second beyond the next event at a time:
/// each call of the kernel ends by itself. Time stays at the last event.
inline void run_until_idle() {
  do {
    const sc_core::sc_time second(1, sc_core::SC_SEC);
    // A call that reached no event would leave time where it is.
    const sc_core::sc_time until_next =
        sc_core::sc_pending_activity() ? sc_core::sc_time_to_pending_activity() : sc_core::SC_ZERO_TIME;
    sc_core::sc_start(until_next + second, sc_core::SC_EXIT_ON_STARVATION);
  } while (sc_core::sc_get_status() == sc_core::SC_PAUSED && sc_core::sc_pending_activity());
}

}  // namespace model
