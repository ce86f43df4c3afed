#pragma once

#include "firmware/cn/chip/transfer.hpp"
#include "model/control/cycle_ledger.hpp"
#include "model/control/host_semaphore_port.hpp"
#include "model/control/semaphores.hpp"
#include "model/control/time_coupling.hpp"
#include "model/pio/pio_port.hpp"

namespace model {

/// How a control unit with one thread waits for a semaphore. Nobody else can queue a request meanwhile, so
/// the PIO engine may decide ahead as far as it takes; only for the host's signals SystemC time must pass.
class SemaphoreWait {
 public:
  SemaphoreWait(CycleLedger& ledger, Semaphores& semaphores, TimeCoupling& time,
                const HostSemaphorePort& host, sc_core::sc_port<PioPort>& pio)
      : ledger_(ledger), semaphores_(semaphores), time_(time), host_(host), pio_(pio) {}

  /// Returns when the signal has arrived and was taken. Throws cn::MachineFault with the wait graph when no
  /// request is left that could signal it; for a semaphore of the host it waits on.
  void wait(cn::Semaphore semaphore);

 private:
  Cycles wait_for_pio(int semaphore);
  Cycles wait_for_host(int semaphore);

  CycleLedger& ledger_;
  Semaphores& semaphores_;
  TimeCoupling& time_;
  const HostSemaphorePort& host_;
  sc_core::sc_port<PioPort>& pio_;
};

}  // namespace model
