#pragma once

namespace testbench {

/// While an InterruptGuard lives, SIGINT (Ctrl-C) and SIGTERM do not kill the process: requested() becomes
/// true, and the run can end cleanly, with what is done. A run that has not ended 1.7 s later is ended, and a
/// second signal ends it at once.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool requested() const;
};

/// Whether the guard of this process, if there is one, was asked to end the run.
bool interrupt_requested();

}  // namespace testbench
