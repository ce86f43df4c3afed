#pragma once

#include <chrono>
#include <string>

namespace testbench {

/// One line on the terminal with a bar, the share done and the time left. Where standard error is a file or a
/// pipe, a line of its own once in half a minute.
class ProgressBar {
 public:
  explicit ProgressBar(std::string label);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Cheap enough to be called often.
  /// @param share the share done, 0 to 1
  void show(double share);

 private:
  using Clock = std::chrono::steady_clock;

  void draw(double share, double left_seconds);

  std::string label_;
  bool on_terminal_;
  bool drawn_ = false;
  Clock::time_point start_;
  Clock::time_point next_;
};

}  // namespace testbench
