#pragma once

#include "model/control/control_statistics.hpp"
#include "model/observe/control_observer.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// The firmware's cycle, and what each cycle went to. Moves the cycle on, adds it to its cause and tells the
/// observer.
class CycleLedger {
 public:
  /// The firmware begins at `cycle`.
  void start(Cycles cycle) { start_cycle_ = now_ = cycle; }
  /// No cycle has been spent.
  void clear() {
    statistics_ = {};
    waits_taken_ = {};
  }
  Cycles start_cycle() const { return start_cycle_; }
  /// The firmware's cycle, at or ahead of SystemC's time.
  Cycles now() const { return now_; }

  /// @param semaphore the one waited on or operated on, -1: none
  void spend(CycleCause cause, Cycles cycles, int semaphore = -1) {
    if (cycles == 0) return;
    statistics_.cycles[std::size_t(cause)] += cycles;
    if (observer_ != nullptr) observer_->spent(cause, now_, now_ + cycles, semaphore);
    now_ += cycles;
  }
  /// Spends up to `cycle`; does nothing when that is over.
  void spend_until(Cycles cycle, CycleCause cause, int semaphore = -1) {
    if (cycle > now_) spend(cause, cycle - now_, semaphore);
  }
  /// The next cycles go to `cause`; how many is not known yet.
  void report_begin(CycleCause cause, int semaphore = -1) {
    if (observer_ != nullptr) observer_->began(cause, now_, semaphore);
  }
  void report_thread(int thread, ThreadState state) {
    if (observer_ != nullptr) observer_->thread_changed(thread, state, now_);
  }

  /// Waits for programmed I/O since this was asked for the last time.
  PioWaits take_waits();

  /// @param sync_cycles after so many cycles at most, what was reported must become the present
  void set_observer(ControlObserver* observer, Cycles sync_cycles);
  ControlObserver* observer() const { return observer_; }
  /// Whether sync_cycles are over. If so, they begin anew.
  bool observer_is_due() {
    if (observer_ == nullptr || now_ < next_sync_) return false;
    next_sync_ = now_ + sync_cycles_;
    return true;
  }

  ControlStatistics& statistics() { return statistics_; }
  const ControlStatistics& statistics() const { return statistics_; }

 private:
  Cycles start_cycle_ = 0;
  Cycles now_ = 0;
  ControlStatistics statistics_;
  PioWaits waits_taken_;

  ControlObserver* observer_ = nullptr;
  Cycles sync_cycles_ = 0;
  Cycles next_sync_ = 0;
};

}  // namespace model
