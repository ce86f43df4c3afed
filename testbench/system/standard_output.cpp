#include "testbench/system/standard_output.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>

#include "testbench/system/descriptor.hpp"
#include "testbench/system/error.hpp"

namespace testbench {

void prepare_standard_streams() {
  // open() returns the lowest free number. What is printed to a closed stream must fail, hence O_RDONLY for
  // output.
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(descriptor, F_GETFD) < 0) open("/dev/null", descriptor == STDOUT_FILENO ? O_RDONLY : O_RDWR);
  // The C library uses the buffer until the process has ended.
  static std::array<char, 1 << 20> buffer;
  if (isatty(STDOUT_FILENO) == 0) std::setvbuf(stdout, buffer.data(), _IOFBF, buffer.size());
}

void finish_standard_output() {
  const bool failed_before = std::ferror(stdout) != 0;
  errno = 0;
  if (std::fflush(stdout) == 0 && !failed_before) return;
  const int error = errno;
  throw RunError("standard output: write error" + (error == 0 ? "" : ": " + system_message(error)));
}

void print_error(const std::string& message) {
  std::fprintf(stderr, "csx600: %s\n", message_line(message).c_str());
}

void print_note(const std::string& message) {
  print_error("note: " + message);
}

}  // namespace testbench
