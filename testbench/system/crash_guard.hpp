#pragma once

#include <string>

namespace testbench {

/// While a CrashGuard lives, what would kill the process without a word (an access outside its memory, a
/// division by zero) ends it with a line on standard error and an exit code. One at a time.
class CrashGuard {
 public:
  /// @param message the line; must outlive the guard
  /// @param detail what the line says instead, once it is not empty; may be null, otherwise outlives the
  /// guard
  CrashGuard(const std::string& message, int exit_code, const std::string* detail = nullptr);
  ~CrashGuard();
  CrashGuard(const CrashGuard&) = delete;
  CrashGuard& operator=(const CrashGuard&) = delete;
};

}  // namespace testbench
