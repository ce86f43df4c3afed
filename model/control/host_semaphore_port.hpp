#pragma once

#include <functional>
#include <systemc>

#include "firmware/cn/chip/poly_memory.hpp"
#include "model/control/semaphores.hpp"
#include "model/control/time_coupling.hpp"

namespace model {

/// The host's side of the semaphores that it shares with the firmware: as a driver sees them, at the present
/// SystemC time.
class HostSemaphorePort {
 public:
  /// @param poly_memory whose access observer is told of signals and waits
  HostSemaphorePort(Semaphores& semaphores, const TimeCoupling& time, const cn::PolyMemory& poly_memory)
      : semaphores_(semaphores), time_(time), poly_memory_(poly_memory) {}

  // For the host:
  /// From now on the firmware's signals of `semaphore` reach firmware_signalled(), and the host may signal
  /// it.
  void share(cn::Semaphore semaphore) { semaphores_.share_with_host(semaphore); }
  const sc_core::sc_event& firmware_signalled() const { return firmware_signalled_; }
  /// Takes one signal that the firmware has given by now; false when there is none.
  bool try_wait(cn::Semaphore semaphore);
  void signal(cn::Semaphore semaphore);
  /// What the host does for work that takes no time: runs at once when the firmware signals it outside timed
  /// code.
  void on_untimed_signal(std::function<void()> service) { untimed_service_ = std::move(service); }

  // For the control unit:
  /// The firmware has signalled a shared semaphore in this cycle. Returns after the host's process, so what
  /// it begins now comes first.
  void tell_host();
  void serve_untimed_signal();
  const sc_core::sc_event& host_signalled() const { return host_signalled_; }

 private:
  Semaphores& semaphores_;
  const TimeCoupling& time_;
  const cn::PolyMemory& poly_memory_;
  sc_core::sc_event firmware_signalled_;
  sc_core::sc_event host_signalled_;
  std::function<void()> untimed_service_;
};

}  // namespace model
