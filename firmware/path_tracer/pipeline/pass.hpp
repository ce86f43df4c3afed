#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/program/run_counts.hpp"
#include "firmware/path_tracer/stages/bins.hpp"

namespace path_tracer {

/// Passes: each takes all live blocks of slots through the ray search, the intersection stage and the path
/// stage. Which blocks are live in the next pass shows while the path steps of the current one run.
class Pass {
 public:
  /// The block has rays for the next pass.
  void add_to_next(int block) { next_.push_back(block); }

  bool has_next() const { return !next_.empty(); }

  /// The next pass becomes the current one.
  void begin() {
    blocks_.swap(next_);
    next_.clear();
    path_steps_left_ = static_cast<int>(blocks_.size());
  }
  /// The current pass's blocks, in order.
  const std::vector<int>& blocks() const { return blocks_; }

  /// A path step was processed.
  /// @return whether it was the last one of the pass
  bool ends_with_this_path_step() { return --path_steps_left_ == 0; }

 private:
  std::vector<int> blocks_;
  std::vector<int> next_;
  int path_steps_left_ = 0;
};

/// Counts the rays of a pass and its blocks.
void count_pass(const std::vector<int>& blocks, const Bins& bins, RunCounts& counts);

}  // namespace path_tracer
