#include "model/control/host_semaphore_port.hpp"

namespace model {

bool HostSemaphorePort::try_wait(cn::Semaphore semaphore) {
  const Cycles cycle = time_.present();
  semaphores_.record().waits(Waiter::host, semaphore, cycle);
  if (!semaphores_.file().has_signal(semaphore.index, cycle)) return false;
  semaphores_.take(semaphore.index);
  semaphores_.record().goes_on(Waiter::host, cycle);
  if (poly_memory_.observer() != nullptr) poly_memory_.observer()->waited(semaphore);
  return true;
}

void HostSemaphorePort::signal(cn::Semaphore semaphore) {
  semaphores_.signal(semaphore.index, Signaller::host, time_.present());
  if (poly_memory_.observer() != nullptr) poly_memory_.observer()->signalled(semaphore);
  host_signalled_.notify(sc_core::SC_ZERO_TIME);
}

void HostSemaphorePort::tell_host() {
  firmware_signalled_.notify(sc_core::SC_ZERO_TIME);
  for (int delta = 0; delta < 2; ++delta) sc_core::wait(sc_core::SC_ZERO_TIME);
}

void HostSemaphorePort::serve_untimed_signal() {
  if (untimed_service_) untimed_service_();
}

}  // namespace model
