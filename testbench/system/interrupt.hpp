#pragma once

namespace testbench {

/// While it lives, Ctrl-C asks instead of killing: requested() turns true and the run ends cleanly.
class InterruptGuard {
 public:
  InterruptGuard();
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  bool requested() const;
};

}  // namespace testbench
