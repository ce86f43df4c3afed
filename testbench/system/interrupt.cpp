#include "testbench/system/interrupt.hpp"

#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <string_view>

#include "testbench/system/descriptor.hpp"

namespace testbench {
namespace {

// A signal handler can reach only static variables.
volatile std::sig_atomic_t is_interrupted = 0;

/// Two seconds, of which the system has a part to take the memory back: a film may be many gigabytes.
constexpr itimerval kTimeToEnd{{0, 0}, {1, 700'000}};

/// Only what POSIX allows in a signal handler.
void end_late_run(int) {
  constexpr std::string_view kMessage = "csx600: interrupted; what was being done could not end in 2 s\n";
  write_all(STDERR_FILENO, kMessage);
  _exit(1);
}

void set_action(int signal, void (*handler)(int), int flags) {
  struct sigaction action {};
  action.sa_handler = handler;
  action.sa_flags = flags;
  sigemptyset(&action.sa_mask);
  sigaction(signal, &action, nullptr);
}

/// The next signal of either kind has its default effect.
void request_interrupt(int) {
  is_interrupted = 1;
  set_action(SIGINT, SIG_DFL, 0);
  set_action(SIGTERM, SIG_DFL, 0);
  setitimer(ITIMER_REAL, &kTimeToEnd, nullptr);
}

}  // namespace

InterruptGuard::InterruptGuard() {
  is_interrupted = 0;
  set_action(SIGALRM, end_late_run, SA_RESTART);
  set_action(SIGINT, request_interrupt, SA_RESTART);
  set_action(SIGTERM, request_interrupt, SA_RESTART);
}

InterruptGuard::~InterruptGuard() {
  constexpr itimerval kNever{};
  setitimer(ITIMER_REAL, &kNever, nullptr);
  for (const int signal : {SIGINT, SIGTERM, SIGALRM}) set_action(signal, SIG_DFL, 0);
}

bool InterruptGuard::requested() const {
  return interrupt_requested();
}

bool interrupt_requested() {
  return is_interrupted != 0;
}

}  // namespace testbench
