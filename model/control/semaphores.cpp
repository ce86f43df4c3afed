#include "model/control/semaphores.hpp"

namespace model {

CycleCause Semaphores::cause_of_wait(int semaphore) const {
  if (is_shared_with_host(semaphore)) return CycleCause::wait_host;
  return record_.latest_transfer(semaphore) == cn::Direction::poly_to_mono ? CycleCause::wait_save
                                                                           : CycleCause::wait_load;
}

}  // namespace model
