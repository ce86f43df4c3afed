#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "firmware/path_tracer/program/program.hpp"

namespace path_tracer {

/// Rays in mono memory, grouped by the treelet that they need next. Each treelet that has rays fills a block
/// of one SIMD width; the blocks come from one pool.
///
/// A block that is partly full for every treelet may be more than the pool has. So there is one queue of rays
/// that need no treelet or for which no block was left. Its blocks are packed, and what the pool keeps back
/// for it takes all rays that are not in a block.
class TreeletQueues {
 public:
  /// Instead of a treelet's first slot: that queue.
  static constexpr std::int32_t kMixed = -1;

  TreeletQueues(const Layout& layout, const ProgramConfig& config, int num_pes);

  struct Block {
    std::int32_t treelet = kMixed;  ///< its first slot
    int rays = 0;
    std::uint64_t last_writer = 0;  ///< the last step that saved to it
  };
  const Block& block(int index) const { return blocks_[std::size_t(index)]; }
  cn::MonoAddress address_of(int index, int ray = 0) const {
    const std::uint64_t place = std::uint64_t(index) * std::uint64_t(num_pes_) + std::uint64_t(ray);
    return first_ + place * std::uint64_t(record_bytes_);
  }

  /// These rays will come, or are over.
  void expect(int rays) { outside_ += rays; }
  void forget(int rays) { outside_ -= rays; }

  /// @param treelet not kMixed, which always has
  bool has_room(std::int32_t treelet, int rays) const;

  /// Where rays are saved to: `room` of them from `address` on, the others from `next_address` on.
  struct Room {
    cn::MonoAddress address = 0;
    int room = 0;
    cn::MonoAddress next_address = 0;
  };
  /// @param rays 1 to a block's, that `step` saves
  Room append(std::int32_t treelet, int rays, std::uint64_t step);

  /// A block to process, to which nothing is appended any more; full ones in the order in which they became
  /// so.
  std::optional<int> take_full();
  /// Of several the one of the treelet that comes first.
  std::optional<int> take_fullest();
  /// It was loaded.
  void release(int index);

 private:
  int room_in(std::int32_t treelet) const;
  int free_block(std::int32_t treelet);
  void fill(int index, int rays, std::uint64_t step);

  cn::MonoAddress first_;
  int record_bytes_;
  int num_pes_;
  int most_taken_;  ///< blocks that are taken, but not yet released
  std::vector<Block> blocks_;
  std::vector<int> free_;
  std::deque<int> full_;
  std::map<std::int32_t, int> open_;  ///< by treelet: the block that is partly full
  int outside_ = 0;                   ///< rays that are in no block, but may come into one
};

}  // namespace path_tracer
