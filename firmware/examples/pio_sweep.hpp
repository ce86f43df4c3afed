#pragma once

#include "firmware/cn/machine.hpp"

namespace examples {

/// The same transfer again and again, each waited for: what programmed I/O does to a program that does not
/// overlap it.
class PioSweep {
 public:
  /// Where the pieces of one transfer are.
  struct Pattern {
    int pes = 0;                     ///< the first so many take part
    int bytes = 0;                   ///< a PE, a multiple of 8
    cn::MonoAddress address = 0;     ///< of PE 0's piece, a multiple of 8
    std::uint64_t stride_bytes = 0;  ///< from PE to PE, a multiple of 8
  };

  /// Throws cn::PolyMemoryOverflow.
  PioSweep(cn::Machine& machine, int largest_bytes);

  void load(const Pattern& pattern, int repeats);
  void save(const Pattern& pattern, int repeats);

 private:
  cn::PolySpan piece(const Pattern& pattern) const { return {buffer_.offset_bytes, pattern.bytes}; }

  cn::Machine& machine_;
  cn::PolySpan buffer_;
  cn::Semaphore done_;
};

}  // namespace examples
