#include "firmware/path_tracer/pipeline/results_handover.hpp"

namespace path_tracer {

void HostSemaphores::allocate(cn::Machine& machine) {
  const cn::Semaphore ready = machine.allocate_semaphore("results ready");
  const cn::Semaphore free = machine.allocate_semaphore("results free");
  if (ready.index != kResultsReady.index || free.index != kResultsFree.index)
    throw cn::MachineFault(
        "the host's semaphores 0 and 1 are taken: a machine runs one program after a reset");
}

void ResultsHandover::announce(int records) {
  machine_.write_mono(layout_.results_header[half_], ResultsHeader{records, 0});
  machine_.sem_signal(HostSemaphores::kResultsReady);
  half_ = 1 - half_;
  if (++announcements_ > 1) machine_.sem_wait(HostSemaphores::kResultsFree);
}

}  // namespace path_tracer
