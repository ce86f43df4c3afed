#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace testbench {

/// A bound on what never ends by itself, such as a kernel of somebody else's that loops for ever: after so
/// many seconds of the wall clock, another thread calls `expired`, which must end the process.
class TimeLimit {
 public:
  /// @param seconds 0: no limit
  /// @param expired receives a line that says so
  TimeLimit(double seconds, std::function<void(const std::string& message)> expired);
  ~TimeLimit();
  TimeLimit(const TimeLimit&) = delete;
  TimeLimit& operator=(const TimeLimit&) = delete;

 private:
  std::mutex mutex_;
  std::condition_variable condition_;
  bool is_over_ = false;
  std::thread thread_;
};

}  // namespace testbench
