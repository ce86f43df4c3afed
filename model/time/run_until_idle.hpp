#pragma once

#include <systemc>

namespace model {

/// Runs the simulation until nothing is left to happen, a simulated second at a time: each call of the kernel
/// ends by itself. Time stays at the last event.
inline void run_until_idle() {
  do {
    sc_core::sc_start(sc_core::sc_time(1, sc_core::SC_SEC), sc_core::SC_EXIT_ON_STARVATION);
  } while (sc_core::sc_get_status() == sc_core::SC_PAUSED && sc_core::sc_pending_activity());
}

}  // namespace model
