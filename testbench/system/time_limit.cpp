#include "testbench/system/time_limit.hpp"

#include <chrono>
#include <cstdio>

namespace testbench {

TimeLimit::TimeLimit(double seconds, std::function<void(const std::string&)> expired) {
  if (seconds <= 0) return;
  thread_ = std::thread([this, seconds, expired = std::move(expired)] {
    std::unique_lock<std::mutex> lock(mutex_);
    if (condition_.wait_for(lock, std::chrono::duration<double>(seconds), [this] { return is_over_; }))
      return;
    char text[32];
    std::snprintf(text, sizeof(text), "%g", seconds);
    expired("--time-limit: the run has not ended after " + std::string(text) + " s");
  });
}

TimeLimit::~TimeLimit() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_over_ = true;
  }
  condition_.notify_one();
  thread_.join();
}

}  // namespace testbench
