#include "model/waves/block_windows.hpp"

#include <algorithm>

namespace model {

BlockWindows::BlockWindows(const std::vector<BlockWindow>& windows, WaveRecorder& recorder)
    : windows_(windows), recorder_(recorder) {
  recorder_.expect_windows(!windows_.empty());
}

void BlockWindows::begin_block(Cycles start) {
  ++blocks_begun_;
  for (const BlockWindow& window : windows_) {
    if (blocks_begun_ == window.first) recorder_.open_at(start);
    if (blocks_begun_ > window.first && blocks_begun_ - window.first == window.count)
      recorder_.close_at(start);
  }
  recorder_.expect_windows(std::any_of(windows_.begin(), windows_.end(), [&](const BlockWindow& window) {
    return blocks_begun_ < window.first || blocks_begun_ - window.first < window.count;
  }));
  if (recorder_.wants_more() && block_starts_.size() < kBlocksRemembered && recorder_.covers(start))
    block_starts_.push_back(start);
}

}  // namespace model
