#include "testbench/system/crash_guard.hpp"

#include <unistd.h>

#include <csignal>
#include <cstring>

namespace testbench {
namespace {

constexpr int kSignals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

// A signal handler can reach only static variables.
const std::string* crash_line = nullptr;
const std::string* crash_detail = nullptr;
int crash_exit_code = 1;

void write_to_standard_error(const char* text, std::size_t size) {
  // Nobody is left to tell if this fails.
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, size);
}

/// Calls nothing that may be in the midst of what crashed.
void end_with_message(int) {
  const std::string& text = crash_detail != nullptr && !crash_detail->empty() ? *crash_detail : *crash_line;
  constexpr const char* kName = "csx600: ";
  write_to_standard_error(kName, std::strlen(kName));
  write_to_standard_error(text.data(), text.size());
  write_to_standard_error("\n", 1);
  _exit(crash_exit_code);
}

}  // namespace

CrashGuard::CrashGuard(const std::string& message, int exit_code, const std::string* detail) {
  crash_line = &message;
  crash_detail = detail;
  crash_exit_code = exit_code;
  for (const int signal : kSignals) std::signal(signal, end_with_message);
}

CrashGuard::~CrashGuard() {
  for (const int signal : kSignals) std::signal(signal, SIG_DFL);
}

}  // namespace testbench
