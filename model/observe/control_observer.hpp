#pragma once

#include <cstdint>

#include "firmware/cn/chip/instruction.hpp"
#include "firmware/cn/chip/label.hpp"
#include "firmware/cn/chip/lane_mask.hpp"
#include "model/time/cycles.hpp"

namespace model {

/// Causes of the control unit's cycles. Every cycle has one; together they are the run.
enum class CycleCause : std::uint8_t {
  poly,            ///< kernels on the PE array
  stolen,          ///< kernels slowed down by programmed I/O at the SRAM ports
  mono,            ///< instructions of the control unit outside kernels
  data_cache,      ///< waiting for a line of mono memory
  semaphore,       ///< signals and waits that did not block
  transfer_call,   ///< software that starts asynchronous copies
  wait_load,       ///< blocked on a semaphore of a mono-to-poly transfer
  wait_save,       ///< blocked on a semaphore of a poly-to-mono transfer
  wait_pio_queue,  ///< blocked because the PIO queue was full
  wait_host,       ///< blocked on a semaphore of the host
  thread_switch,   ///< switching from one hardware thread to another
};

inline constexpr int kCycleCauses = static_cast<int>(CycleCause::thread_switch) + 1;

const char* cycle_cause_name(CycleCause cause);

/// What a hardware thread does.
enum class ThreadState : std::uint8_t { none, ready, running, waiting };
inline constexpr int kThreadStates = static_cast<int>(ThreadState::waiting) + 1;

const char* thread_state_name(ThreadState state);

/// More about a kernel than its name and time. The pointers are valid during the call.
struct KernelDetails {
  const cn::LaneMask* lanes;    ///< PEs that it was started for; null: all
  const cn::IssueTree* issued;  ///< its instructions
  cn::Label label;
};

/// Told how the control unit spends its time, span by span, in order and without gaps, ahead of SystemC time.
class ControlObserver {
 public:
  virtual ~ControlObserver() = default;

  /// The control unit spends its time on `cause` from `start` on; told before time may pass and the end is
  /// known. `spent` or `ran_kernel` with the same start follows, unless it takes no time.
  virtual void began(CycleCause /*cause*/, Cycles /*start*/, int /*semaphore*/) {}
  virtual void kernel_details(const KernelDetails& /*details*/) {}  ///< right before began_kernel
  virtual void began_kernel(const char* /*name*/, Cycles /*start*/, int /*enabled_pes*/) {}

  /// [start, finish) went to `cause`; empty spans are not reported. `semaphore` is the one waited on or -1.
  virtual void spent(CycleCause cause, Cycles start, Cycles finish, int semaphore) = 0;

  /// A kernel runs in [start, finish), stolen cycles included. `enabled_pes` are those it was started for.
  virtual void ran_kernel(const char* name, Cycles start, Cycles finish, int enabled_pes) = 0;

  /// A hardware thread is in `state` from `at` on.
  virtual void thread_changed(int /*thread*/, ThreadState /*state*/, Cycles /*at*/) {}

  /// A block of the firmware's bins holds work in `slots` slots from `at` on (cn::Machine::report_fill).
  virtual void filled(int /*block*/, int /*slots*/, Cycles /*at*/) {}
};

}  // namespace model
