#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "firmware/path_tracer/program/program.hpp"

namespace path_tracer {

/// The temporary bin. Where the paper swaps two bins, this is one ring: rays that go on are saved behind the
/// others, packed. A block that is only partly full waits for more instead of being processed with idle PEs,
/// until nothing else is left.
class TraversalBin {
 public:
  TraversalBin(const Layout& layout, const ProgramConfig& config, int num_pes);

  /// The next full block of the ring, if there is one.
  std::optional<int> take_full();
  /// What is left, as a block.
  std::optional<int> take_rest();

  int rays(int block) const { return block_[std::size_t(block)].rays; }
  /// How often the rays of the block have been through the bin, 1 for the first time.
  std::size_t pass(int block) const { return block_[std::size_t(block)].pass; }

  /// Rays that `step` appends; they were in `pass` before, 0 for the ray bin.
  void append(int rays, std::uint64_t step, std::size_t pass);

  cn::MonoAddress address() const { return first_; }
  cn::MonoAddress address_of(int block) const {
    return first_ + std::uint64_t(block) * std::uint64_t(num_pes_) * std::uint64_t(record_bytes_);
  }
  int record_bytes() const { return record_bytes_; }
  int capacity() const { return blocks_ * num_pes_; }
  std::int32_t tail() const { return static_cast<std::int32_t>(tail_ % std::uint64_t(capacity())); }
  /// The last step that saved to the block.
  std::uint64_t last_writer(int block) const { return block_[std::size_t(block)].last_writer; }

 private:
  struct Block {
    int rays = 0;  ///< when it was taken
    std::size_t pass = 0;
    std::uint64_t last_writer = 0;
  };
  int take(int rays);

  cn::MonoAddress first_;
  int record_bytes_;
  int num_pes_;
  int blocks_;
  // Rays are numbered on and on; these lie at their number modulo the capacity.
  std::uint64_t head_ = 0;  ///< a multiple of num_pes
  std::uint64_t tail_ = 0;
  struct PassStart {
    std::uint64_t ray;
    std::size_t pass;
  };
  std::deque<PassStart> passes_;  ///< that the rays in the ring are in
  std::vector<Block> block_;
};

}  // namespace path_tracer
