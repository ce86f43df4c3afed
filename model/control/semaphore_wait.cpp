#include "model/control/semaphore_wait.hpp"

#include <algorithm>

#include "firmware/cn/machine.hpp"

namespace model {

void SemaphoreWait::wait(cn::Semaphore semaphore) {
  semaphores_.record().waits(Waiter::control_unit, semaphore, ledger_.now());
  const Cycles at = semaphores_.is_shared_with_host(semaphore.index) ? wait_for_host(semaphore.index)
                                                                     : wait_for_pio(semaphore.index);
  ledger_.spend_until(at, semaphores_.cause_of_wait(semaphore.index), semaphore.index);
  semaphores_.record().goes_on(Waiter::control_unit, ledger_.now());
}

Cycles SemaphoreWait::wait_for_pio(int semaphore) {
  std::optional<Cycles> at = semaphores_.take(semaphore);
  if (!at) ledger_.report_begin(semaphores_.cause_of_wait(semaphore), semaphore);
  while (!at && time_.serve_next_request()) at = semaphores_.take(semaphore);
  if (!at) throw cn::MachineFault(semaphores_.deadlock(std::max(ledger_.now(), time_.present())));
  return *at;
}

Cycles SemaphoreWait::wait_for_host(int semaphore) {
  std::optional<Cycles> at = semaphores_.take(semaphore);
  if (at) return *at;
  time_.synchronise();  // the host may answer while time catches up
  ledger_.report_begin(CycleCause::wait_host, semaphore);
  // Queued requests are served in their time.
  while (!(at = semaphores_.take(semaphore))) time_.wait_for(host_.host_signalled(), pio_->next_start());
  return *at;
}

}  // namespace model
