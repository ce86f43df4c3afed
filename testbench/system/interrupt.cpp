#include "testbench/system/interrupt.hpp"

#include <csignal>

namespace testbench {
namespace {

// A signal handler can reach only static variables.
volatile std::sig_atomic_t interrupt_requested = 0;

void request_interrupt(int) {
  interrupt_requested = 1;
}

}  // namespace

InterruptGuard::InterruptGuard() {
  interrupt_requested = 0;
  std::signal(SIGINT, request_interrupt);
  std::signal(SIGTERM, request_interrupt);
}

InterruptGuard::~InterruptGuard() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

bool InterruptGuard::requested() const {
  return interrupt_requested != 0;
}

}  // namespace testbench
