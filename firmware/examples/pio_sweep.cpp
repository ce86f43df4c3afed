#include "firmware/examples/pio_sweep.hpp"

#include "firmware/examples/mono_cost.hpp"

namespace examples {

PioSweep::PioSweep(cn::Machine& machine, int largest_bytes)
    : machine_(machine),
      buffer_(machine.poly_memory().allocate("piece", largest_bytes)),
      done_(machine.allocate_semaphore("done")) {}

void PioSweep::load(const Pattern& pattern, int repeats) {
  for (int i = 0; i < repeats; ++i) {
    machine_.issue_mono(kRequestInstructions);
    machine_.async_copy_m2p(done_, piece(pattern),
                            cn::MonoPlaces::array(pattern.address, pattern.stride_bytes),
                            cn::LaneMask::first(pattern.pes));
    machine_.sem_wait(done_);
  }
}

void PioSweep::save(const Pattern& pattern, int repeats) {
  for (int i = 0; i < repeats; ++i) {
    machine_.issue_mono(kRequestInstructions);
    machine_.async_copy_p2m(done_, cn::MonoPlaces::array(pattern.address, pattern.stride_bytes),
                            piece(pattern), cn::LaneMask::first(pattern.pes));
    machine_.sem_wait(done_);
  }
}

}  // namespace examples
