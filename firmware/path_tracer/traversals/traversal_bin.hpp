#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "firmware/path_tracer/program/layout.hpp"

namespace path_tracer {

/// The traversal bin: the temporary bin of the paper's section 5. Where the paper swaps two bins, this is one
/// ring: remaining rays are saved behind the others, packed. A partly full block waits for more rays, instead
/// of being processed with idle PEs, until no others are left.
class TraversalBin {
 public:
  TraversalBin(const Layout& layout, const ProgramConfig& config, int num_pes);

  /// Takes the next full block of the ring, if there is one.
  std::optional<int> take_full();
  /// Takes the remaining rays as a block.
  std::optional<int> take_rest();

  int rays(int block) const { return block_[std::size_t(block)].rays; }
  /// Number of times that the rays of the block have been in the bin, from 1.
  std::size_t pass(int block) const { return block_[std::size_t(block)].pass; }

  /// Appends the rays of `step`. They were in `pass` before; rays from the ray queue were in pass 0.
  void append(int rays, std::uint64_t step, std::size_t pass);

  cn::MonoAddress address() const { return first_; }
  cn::MonoAddress address_of(int block) const {
    return first_ + std::uint64_t(block) * std::uint64_t(num_pes_) * std::uint64_t(record_bytes_);
  }
  int record_bytes() const { return record_bytes_; }
  int capacity() const { return blocks_ * num_pes_; }
  std::int32_t tail() const { return static_cast<std::int32_t>(tail_ % std::uint64_t(capacity())); }
  /// The latest step that saved to the block.
  std::uint64_t last_writer(int block) const { return block_[std::size_t(block)].last_writer; }

 private:
  struct Block {
    int rays = 0;  ///< number when the block was taken
    std::size_t pass = 0;
    std::uint64_t last_writer = 0;
  };
  int take(int rays);

  cn::MonoAddress first_;
  int record_bytes_;
  int num_pes_;
  int blocks_;
  // Rays have ascending numbers; a ray lies at its number modulo the capacity.
  std::uint64_t head_ = 0;  ///< a multiple of num_pes
  std::uint64_t tail_ = 0;
  struct PassStart {
    std::uint64_t ray;
    std::size_t pass;
  };
  std::deque<PassStart> passes_;  ///< passes of the rays in the ring
  std::vector<Block> block_;
};

}  // namespace path_tracer
