#include "testbench/system/progress_bar.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace testbench {
namespace {

constexpr std::chrono::milliseconds kBetweenBars(100);
constexpr std::chrono::milliseconds kBetweenLines(30'000);

}  // namespace

ProgressBar::ProgressBar(std::string label)
    : label_(std::move(label)),
      on_terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_(on_terminal_ ? start_ : start_ + kBetweenLines) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(double share) {
  const Clock::time_point now = Clock::now();
  if (now < next_) return;
  next_ = now + (on_terminal_ ? kBetweenBars : kBetweenLines);
  const double elapsed_seconds = std::chrono::duration<double>(now - start_).count();
  const double left_seconds = share > 0 ? elapsed_seconds * (1 - share) / share : 0;
  if (on_terminal_) return draw(share, left_seconds);
  std::fprintf(stderr, "%s: %.1f %%, %.0f s left\n", label_.c_str(), 100 * share, left_seconds);
}

void ProgressBar::draw(double share, double left_seconds) {
  constexpr int kWidth = 30;
  const int filled = std::clamp(static_cast<int>(share * kWidth), 0, kWidth);
  std::fprintf(stderr, "\r%s [%.*s%*s] %5.1f %%  %.0f s left\033[K", label_.c_str(), filled,
               "##############################", kWidth - filled, "", 100 * share, left_seconds);
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace testbench
