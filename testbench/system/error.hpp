#pragma once

#include <stdexcept>
#include <string>
#include <utility>

#include "testbench/system/message_text.hpp"

namespace testbench {

/// Wrong usage or wrong input. The message is one line that names the file, key or argument, what was found
/// and what is allowed; what it quotes is made printable and short (message_line()). The command line prints
/// it and exits with code 2.
class InputError : public std::runtime_error {
 public:
  /// @param details a table to print below the message, lines that the program itself has made
  explicit InputError(const std::string& message, std::string details = "")
      : std::runtime_error(message_line(message)), details_(std::move(details)) {}

  const std::string& details() const { return details_; }

 private:
  std::string details_;
};

/// A run that failed although its input was right (disk full, broken invariant). Its message is made as
/// InputError's is. Exit code 1.
class RunError : public std::runtime_error {
 public:
  explicit RunError(const std::string& message) : std::runtime_error(message_line(message)) {}
};

/// What std::bad_alloc means to the user. Exit code 1.
inline constexpr const char* kOutOfMemory = "out of memory: the operating system gives this run no more";

/// The first line of a library's message.
inline std::string first_line(const std::string& text) {
  return text.substr(0, text.find_first_of("\r\n"));
}

}  // namespace testbench
