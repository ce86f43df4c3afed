#pragma once

#include <optional>
#include <systemc>

#include "model/config/timing_style.hpp"
#include "model/control/cycle_ledger.hpp"
#include "model/network/booked_traffic.hpp"
#include "model/pio/pio_port.hpp"
#include "model/time/clock_domain.hpp"

namespace model {

/// Keeps the PIO engine and SystemC time in step with the firmware, which runs ahead of them: the engine is
/// settled up to the firmware's cycle before anything depends on it, and SystemC time follows where someone
/// else can see it. While the host uses the network, nothing is settled ahead of SystemC time, because what
/// the host begins next must not come after requests that were booked for later.
///
/// The same holds beside other initiators of the memory, such as a second chip: each books its accesses when
/// SystemC time has come near (approach()), so that they contend in the order of time.
class TimeCoupling {
 public:
  TimeCoupling(const ClockDomain& clock, CycleLedger& ledger, sc_core::sc_port<PioPort>& pio,
               BookedTrafficPort& booked_traffic, TimingStyle timing)
      : clock_(clock), ledger_(ledger), pio_(pio), booked_traffic_(booked_traffic), timing_(timing) {}

  /// Others than this chip may use its mono memory.
  void share_memory() { memory_is_shared_ = true; }

  /// The cycle of SystemC time.
  Cycles present() const { return clock_.cycle_at(sc_core::sc_time_stamp()); }

  /// Settles the PIO engine up to `cycle`.
  void settle_pio(Cycles cycle) {
    if (host_is_transferring()) settle_pio_beside_host(cycle);
    pio_->settle(cycle);
    approach(cycle);
  }
  /// Lets SystemC time come to `cycle` if the firmware must not run so far ahead. It may by SystemC's global
  /// quantum (tlm::tlm_global_quantum, IEEE 1666-2011, 16.2). If that is zero, its default, it may not at all
  /// where others use the memory, and without end where nobody could notice.
  void approach(Cycles cycle);
  /// Serves the next queued request, whenever it starts; false when none is queued.
  bool serve_next_request();

  /// SystemC time catches up with the firmware.
  void synchronise();
  /// Makes the present of what was reported to the observer, before too much of it lies in the future.
  void synchronise_for_observer() {
    if (ledger_.observer_is_due()) synchronise();
  }

  /// Lets SystemC time pass until `event` or, if given, until the cycle `at_the_latest`.
  void wait_for(const sc_core::sc_event& event, std::optional<Cycles> at_the_latest);

 private:
  /// How far the firmware may be ahead of SystemC time; std::nullopt: without end.
  std::optional<sc_core::sc_time> allowed_lead() const;
  bool host_is_transferring() const { return in_progress(booked_traffic_); }
  void settle_pio_beside_host(Cycles cycle);
  /// Waits until `cycle`, and lets the host's process come first in it.
  void wait_behind_host(Cycles cycle);
  void wait_until(Cycles cycle);

  ClockDomain clock_;
  CycleLedger& ledger_;
  sc_core::sc_port<PioPort>& pio_;
  BookedTrafficPort& booked_traffic_;
  TimingStyle timing_;
  bool memory_is_shared_ = false;
};

}  // namespace model
