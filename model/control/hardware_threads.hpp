#pragma once

#include <exception>
#include <functional>
#include <string>
#include <systemc>

#include "model/config/chip_config.hpp"
#include "model/control/cycle_ledger.hpp"
#include "model/control/host_semaphore_port.hpp"
#include "model/control/semaphore_wait.hpp"
#include "model/control/semaphores.hpp"
#include "model/control/thread_processes.hpp"
#include "model/control/thread_scheduler.hpp"
#include "model/control/time_coupling.hpp"
#include "model/pio/pio_port.hpp"

namespace model {

/// Runs the firmware's threads on the control unit's one instruction stream, from the firmware's start to its
/// end: gives the stream from one to the other as ThreadScheduler decides, lets them wait for semaphores, and
/// keeps what one of them threw. The stream changes hands at a wait that blocks and, for a thread of higher
/// priority, where the control unit says that it may.
class HardwareThreads {
 public:
  HardwareThreads(const ChipConfig::Control& config, CycleLedger& ledger, Semaphores& semaphores,
                  TimeCoupling& time, const HostSemaphorePort& host, sc_core::sc_port<PioPort>& pio);

  /// Runs the firmware's first thread on the calling process, which it needs until finished().
  void run_first(const std::function<void()>& body);
  /// A further thread, ready at once.
  void start(int priority, const std::string& name, std::function<void()> body);
  /// To be called where a thread of higher priority may take over: it does if it is ready.
  void let_higher_priority_run();
  /// The running thread waits for `semaphore`; returns when it has taken a signal and runs again.
  void wait(cn::Semaphore semaphore);

  /// All threads are over, or one has failed.
  bool finished() const { return finished_; }
  bool failed() const { return failure_ != nullptr; }
  /// After finished(): run_first() may be called again.
  void begin_again();
  const sc_core::sc_event& finished_event() const { return finished_event_; }
  /// Throws what a thread threw, if one did.
  void rethrow_failure() const;

 private:
  void run(const std::function<void()>& body);
  void wait_among_threads(int semaphore);
  int choose_thread();
  ThreadScheduler::Ready wait_until_one_is_ready();
  bool one_waits_for_host() const;
  void dispatch(int thread);
  void switch_to(int thread, int self);

  int limit_;
  Cycles switch_cycles_;
  CycleLedger& ledger_;
  Semaphores& semaphores_;
  TimeCoupling& time_;
  const HostSemaphorePort& host_;
  sc_core::sc_port<PioPort>& pio_;

  ThreadScheduler scheduler_;
  ThreadProcesses processes_;
  SemaphoreWait wait_alone_;
  bool finished_ = false;
  sc_core::sc_event finished_event_;
  std::exception_ptr failure_;
};

}  // namespace model
