#pragma once

#include <stdexcept>
#include <string>

namespace testbench {

/// Wrong usage or wrong input. The message is one line that names the file, key or argument, what was found
/// and what is allowed. The command line prints it and exits with code 2.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A run that failed although its input was right (disk full, broken invariant). Exit code 1.
class RunError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What std::bad_alloc means to the user. Exit code 1.
inline constexpr const char* kOutOfMemory = "out of memory: the operating system gives this run no more";

/// The first line of a library's message.
inline std::string first_line(const std::string& text) {
  return text.substr(0, text.find_first_of("\r\n"));
}

}  // namespace testbench
