#pragma once

#include <deque>
#include <map>
#include <optional>
#include <vector>

#include "firmware/path_tracer/program/layout.hpp"

namespace path_tracer {

/// Rays in mono memory, grouped by the treelet that they need next. Each treelet with rays fills a block of
/// one SIMD width; the blocks come from one pool.
///
/// The pool may have fewer blocks than a partly full one for every treelet. So there is one mixed queue, for
/// rays that need no treelet or found no free block. Its blocks are packed, and the pool keeps back enough
/// blocks for it to take all rays that are in no block.
class TreeletQueues {
 public:
  /// Number of the mixed queue, instead of a treelet's first slot.
  static constexpr std::int32_t kMixed = -1;

  TreeletQueues(const Layout& layout, const ProgramConfig& config, int num_pes);

  struct Block {
    std::int32_t treelet = kMixed;  ///< its first slot
    int rays = 0;
    std::uint64_t last_writer = 0;  ///< the latest step that saved to it
  };
  const Block& block(int index) const { return blocks_[std::size_t(index)]; }
  cn::MonoAddress address_of(int index, int ray = 0) const {
    const std::uint64_t place = std::uint64_t(index) * std::uint64_t(num_pes_) + std::uint64_t(ray);
    return first_ + place * std::uint64_t(record_bytes_);
  }

  /// Adds or removes rays that may still be queued.
  void expect(int rays) { outside_ += rays; }
  void forget(int rays) { outside_ -= rays; }

  /// @param treelet not kMixed, which always has room
  bool has_room(std::int32_t treelet, int rays) const;

  /// Where rays are saved: `room` of them from `address` on, the others from `next_address` on.
  struct Room {
    cn::MonoAddress address = 0;
    int room = 0;
    cn::MonoAddress next_address = 0;
  };
  /// @param rays number of rays that `step` saves, 1 to a block's
  Room append(std::int32_t treelet, int rays, std::uint64_t step);

  /// Takes a full block to process; nothing is appended to it any more. Blocks come in the order in which
  /// they became full.
  std::optional<int> take_full();
  /// Takes the fullest of the partly full blocks; among equals, the one of the first treelet.
  std::optional<int> take_fullest();
  /// Returns a loaded block to the pool.
  void release(int index);

 private:
  int room_in(std::int32_t treelet) const;
  int free_block(std::int32_t treelet);
  void fill(int index, int rays, std::uint64_t step);

  cn::MonoAddress first_;
  int record_bytes_;
  int num_pes_;
  int most_taken_;  ///< maximum number of blocks that are taken and not yet released
  std::vector<Block> blocks_;
  std::vector<int> free_;
  std::deque<int> full_;
  std::map<std::int32_t, int> open_;  ///< the partly full block of each treelet
  int outside_ = 0;                   ///< rays that are in no block but may be queued
};

}  // namespace path_tracer
