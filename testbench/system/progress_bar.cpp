#include "testbench/system/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace testbench {

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)),
      on_terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_(start_) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(double share) {
  if (!on_terminal_) return;
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + std::chrono::milliseconds(100);
  constexpr int kWidth = 30;
  const int filled = std::clamp(static_cast<int>(share * kWidth), 0, kWidth);
  const double elapsed_seconds = std::chrono::duration<double>(now - start_).count();
  const double left_seconds = share > 0 ? elapsed_seconds * (1 - share) / share : 0;
  std::fprintf(stderr, "\r%s [%.*s%*s] %5.1f %%  %.0f s left\033[K", label_.c_str(), filled,
               "##############################", kWidth - filled, "", 100 * share, left_seconds);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace testbench
