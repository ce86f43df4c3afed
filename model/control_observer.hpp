#pragma once

#include <cstdint>

#include "model/cycles.hpp"

namespace model {

/// What the control unit's cycles go to. Every cycle has one cause; they add up to the run.
enum class CycleCause : std::uint8_t {
  poly,            ///< kernels on the PE array
  stolen,          ///< kernels slowed down by programmed I/O at the SRAM ports
  mono,            ///< instructions of its own outside kernels
  data_cache,      ///< waiting for a line of mono memory
  semaphore,       ///< signals and waits that did not block
  transfer_call,   ///< software that starts asynchronous copies
  wait_load,       ///< blocked on a semaphore of a mono-to-poly transfer
  wait_save,       ///< blocked on a semaphore of a poly-to-mono transfer
  wait_pio_queue,  ///< blocked because the PIO queue was full
  wait_host,       ///< blocked on a semaphore of the host
  thread_switch,   ///< from one hardware thread to another
};

inline constexpr int kCycleCauses = static_cast<int>(CycleCause::thread_switch) + 1;

const char* cycle_cause_name(CycleCause cause);

/// Told how the control unit spends its time, span by span, in order and without gaps, ahead of SystemC time.
class ControlObserver {
 public:
  virtual ~ControlObserver() = default;

  /// What the control unit does from `start` on, told before time may pass and its end is known. `spent` or
  /// `ran_kernel` with the same start follows, unless it takes no time.
  virtual void began(CycleCause /*cause*/, Cycles /*start*/, int /*semaphore*/) {}
  virtual void began_kernel(const char* /*name*/, Cycles /*start*/, int /*enabled_pes*/) {}

  /// [start, finish) went to `cause`; empty spans are not reported. `semaphore` is the one waited on or -1.
  virtual void spent(CycleCause cause, Cycles start, Cycles finish, int semaphore) = 0;

  /// A kernel runs in [start, finish), stolen cycles included. `enabled_pes` are those it was started for.
  virtual void ran_kernel(const char* name, Cycles start, Cycles finish, int enabled_pes) = 0;
};

}  // namespace model
