#include "firmware/path_tracer/program/run_counts.hpp"

namespace path_tracer {

void PassCounts::add(std::uint64_t count) {
  if (passes_ == passes_per_interval_ * kMaxIntervals) {
    for (std::size_t i = 0; i < kMaxIntervals / 2; ++i)
      intervals_[i] = intervals_[2 * i] + intervals_[2 * i + 1];
    intervals_.resize(kMaxIntervals / 2);
    passes_per_interval_ *= 2;
  }
  if (passes_ == passes_per_interval_ * intervals_.size()) intervals_.push_back(0);
  intervals_.back() += count;
  ++passes_;
}

}  // namespace path_tracer
