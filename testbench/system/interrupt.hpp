#pragma once

namespace testbench {

/// While an InterruptGuard lives, SIGINT (Ctrl-C) and SIGTERM do not kill the process: requested() becomes
/// true, and the run can end cleanly.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool requested() const;
};

}  // namespace testbench
