#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "firmware/cn/simd/lanes.hpp"

namespace cn {

class AccessObserver;

/// A piece of every PE's SRAM, at the same address in each.
struct PolySpan {
  int offset_bytes = 0;
  int size_bytes = 0;
};

/// Thrown when named buffers do not fit a PE's SRAM. The message is one line; the map lists the buffers.
class PolyMemoryOverflow : public std::runtime_error {
 public:
  PolyMemoryOverflow(const std::string& message, std::string map)
      : std::runtime_error(message), map_(std::move(map)) {}
  const std::string& map() const { return map_; }

 private:
  std::string map_;
};

/// The SRAM of all PEs. A strip's PEs lie side by side, word after word. So a kernel reads one variable of
/// all of them as a vector, and a record as consecutive cache lines of the simulator, at offsets that do not
/// depend on the number of PEs. Buffers have names and are only ever freed all at once, as static storage of
/// a program.
class PolyMemory {
 public:
  struct Buffer {
    std::string name;
    PolySpan span;
  };

  /// The ABI keeps the PE number in the top 16 bytes (SDK Reference Manual 3.1, p. 163).
  static constexpr int kReservedBytes = 16;

  /// @param bytes_per_pe a multiple of 8
  PolyMemory(int num_pes, int bytes_per_pe);

  /// 8-byte aligned; throws PolyMemoryOverflow.
  PolySpan allocate(const std::string& name, int size_bytes);
  void free_all() { buffers_.clear(); }

  int num_pes() const { return num_pes_; }
  int capacity_bytes() const { return capacity_bytes_; }
  int used_bytes() const;
  const std::vector<Buffer>& buffers() const { return buffers_; }
  std::string map() const;

  /// Sets who is told of every access from now on; may be null.
  void set_observer(AccessObserver* observer) { observer_ = observer; }
  AccessObserver* observer() const { return observer_; }

  /// The whole memory, strip after strip.
  std::uint64_t* words() { return reinterpret_cast<std::uint64_t*>(lines_.data()); }
  const std::uint64_t* words() const { return reinterpret_cast<const std::uint64_t*>(lines_.data()); }

  /// Stride between strips, in words.
  std::size_t strip_words() const { return lines_a_strip_ * kStripLanes; }
  /// The strip's words at an address: word w of lane i is at [w * kStripLanes + i].
  /// @param offset_bytes a multiple of 8
  std::uint64_t* strip(int first_pe, int offset_bytes = 0) { return words() + index(first_pe, offset_bytes); }
  const std::uint64_t* strip(int first_pe, int offset_bytes = 0) const {
    return words() + index(first_pe, offset_bytes);
  }

  /// The word of one PE at an address, a multiple of 8.
  std::uint64_t& word(int pe, int offset_bytes) { return words()[index(pe, offset_bytes)]; }
  const std::uint64_t& word(int pe, int offset_bytes) const { return words()[index(pe, offset_bytes)]; }

 private:
  std::size_t index(int pe, int offset_bytes) const {
    constexpr unsigned kLanes = kStripLanes;
    return unsigned(pe) / kLanes * strip_words() + std::size_t(unsigned(offset_bytes) / 8 * kLanes) +
           unsigned(pe) % kLanes;
  }

  int num_pes_;
  int capacity_bytes_;
  std::vector<Buffer> buffers_;
  /// One word of a strip's PEs on its own cache line, because a vector that straddles two lines costs twice.
  struct alignas(64) Line {
    std::uint64_t word[kStripLanes];
  };
  std::size_t lines_a_strip_;
  std::vector<Line> lines_;
  AccessObserver* observer_ = nullptr;
};

}  // namespace cn
