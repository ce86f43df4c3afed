#include "firmware/path_tracer/traversals/traversal_bin.hpp"

namespace path_tracer {

TraversalBin::TraversalBin(const Layout& layout, const ProgramConfig& config, int num_pes)
    : first_(layout.traversal_bin.address),
      record_bytes_(config.tree.record_bytes()),
      num_pes_(num_pes),
      blocks_(traversal_bin_blocks(config)),
      block_(std::size_t(blocks_)) {}

int TraversalBin::take(int rays) {
  while (passes_.size() > 1 && passes_[1].ray <= head_) passes_.pop_front();
  const auto index = static_cast<int>(head_ / std::uint64_t(num_pes_) % std::uint64_t(blocks_));
  block_[std::size_t(index)].rays = rays;
  block_[std::size_t(index)].pass = passes_.front().pass;
  head_ += std::uint64_t(num_pes_);
  return index;
}

std::optional<int> TraversalBin::take_full() {
  if (tail_ < head_ + std::uint64_t(num_pes_)) return {};
  return take(num_pes_);
}

std::optional<int> TraversalBin::take_rest() {
  if (tail_ == head_) return {};
  const int block = take(static_cast<int>(tail_ - head_));
  tail_ = head_;
  return block;
}

void TraversalBin::append(int rays, std::uint64_t step, std::size_t pass) {
  if (rays == 0) return;  // nobody need wait for that step
  if (tail_ == head_) passes_.clear();
  if (passes_.empty() || passes_.back().pass != pass + 1) passes_.push_back({tail_, pass + 1});
  const auto pes = std::uint64_t(num_pes_);
  for (std::uint64_t block = tail_ / pes; block * pes < tail_ + std::uint64_t(rays); ++block)
    block_[std::size_t(block % std::uint64_t(blocks_))].last_writer = step;
  tail_ += std::uint64_t(rays);
}

}  // namespace path_tracer
