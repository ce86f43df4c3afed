#include "firmware/path_tracer/traversals/treelet_queues.hpp"

#include <algorithm>

namespace path_tracer {

TreeletQueues::TreeletQueues(const Layout& layout, const ProgramConfig& config, int num_pes)
    : first_(layout.treelet_pool.address),
      record_bytes_(config.tree.record_bytes()),
      num_pes_(num_pes),
      most_taken_(record_steps(config)),
      blocks_(std::size_t(layout.treelet_pool_blocks)) {
  for (int i = layout.treelet_pool_blocks; i > 0; --i) free_.push_back(i - 1);
}

int TreeletQueues::room_in(std::int32_t treelet) const {
  const auto open = open_.find(treelet);
  return open == open_.end() ? 0 : num_pes_ - block(open->second).rays;
}

/// The pool keeps back blocks for all rays that may come, one partly full block, and those that were taken
/// when they were partly full.
bool TreeletQueues::has_room(std::int32_t treelet, int rays) const {
  if (rays <= room_in(treelet)) return true;
  const int kept = (outside_ + num_pes_ - 1) / num_pes_ + 1 + most_taken_;
  return static_cast<int>(free_.size()) > kept;
}

int TreeletQueues::free_block(std::int32_t treelet) {
  const int index = free_.back();
  free_.pop_back();
  blocks_[std::size_t(index)] = {treelet, 0, 0};
  open_[treelet] = index;
  return index;
}

void TreeletQueues::fill(int index, int rays, std::uint64_t step) {
  Block& filled = blocks_[std::size_t(index)];
  filled.rays += rays;
  filled.last_writer = step;
  if (filled.rays < num_pes_) return;
  open_.erase(filled.treelet);
  full_.push_back(index);
}

TreeletQueues::Room TreeletQueues::append(std::int32_t treelet, int rays, std::uint64_t step) {
  outside_ -= rays;
  const auto open = open_.find(treelet);
  const int index = open == open_.end() ? free_block(treelet) : open->second;
  const int room = std::min(rays, num_pes_ - block(index).rays);
  Room where{address_of(index, block(index).rays), room, 0};
  fill(index, room, step);
  if (rays > room) {
    const int next = free_block(treelet);
    where.next_address = address_of(next);
    fill(next, rays - room, step);
  }
  return where;
}

std::optional<int> TreeletQueues::take_full() {
  if (full_.empty()) return {};
  const int index = full_.front();
  full_.pop_front();
  return index;
}

std::optional<int> TreeletQueues::take_fullest() {
  const auto fullest = std::max_element(open_.begin(), open_.end(), [&](const auto& a, const auto& b) {
    return block(a.second).rays < block(b.second).rays;
  });
  if (fullest == open_.end()) return {};
  const int index = fullest->second;
  open_.erase(fullest);
  return index;
}

void TreeletQueues::release(int index) {
  outside_ += block(index).rays;
  free_.push_back(index);
}

}  // namespace path_tracer
