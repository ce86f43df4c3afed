#include "model/control/cycle_ledger.hpp"

namespace model {

void CycleLedger::spend(CycleCause cause, Cycles cycles, int semaphore) {
  if (cycles == 0) return;
  statistics_.cycles[std::size_t(cause)] += cycles;
  if (observer_ != nullptr) observer_->spent(cause, now_, now_ + cycles, semaphore);
  now_ += cycles;
}

void CycleLedger::report_begin(CycleCause cause, int semaphore) {
  if (observer_ != nullptr) observer_->began(cause, now_, semaphore);
}

void CycleLedger::report_thread(int thread, ThreadState state) {
  if (observer_ != nullptr) observer_->thread_changed(thread, state, now_);
}

PioWaits CycleLedger::take_waits() {
  const PioWaits waits = statistics_.pio_waits();
  const PioWaits since = waits - waits_taken_;
  waits_taken_ = waits;
  return since;
}

void CycleLedger::set_observer(ControlObserver* observer, Cycles sync_cycles) {
  observer_ = observer;
  sync_cycles_ = sync_cycles;
}

bool CycleLedger::observer_is_due() {
  if (observer_ == nullptr || now_ < next_sync_) return false;
  next_sync_ = now_ + sync_cycles_;
  return true;
}

}  // namespace model
