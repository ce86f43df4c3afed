#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace cn {

class AccessObserver;

/// A piece of every PE's SRAM, at the same address in each.
struct PolySpan {
  int offset_bytes = 0;
  int size_bytes = 0;
};

/// Thrown when named buffers do not fit a PE's SRAM; the message is one line, the map says who holds what.
class PolyMemoryOverflow : public std::runtime_error {
 public:
  PolyMemoryOverflow(const std::string& message, std::string map)
      : std::runtime_error(message), map_(std::move(map)) {}
  const std::string& map() const { return map_; }

 private:
  std::string map_;
};

/// The SRAM of all PEs. Word w of PE p is kept at [w * num_pes + p], so that a kernel reads one variable of
/// neighbouring PEs as a vector. Buffers have names and are only ever freed all at once, as static storage of
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

  /// Told of every access from now on; may be null.
  void set_observer(AccessObserver* observer) { observer_ = observer; }
  AccessObserver* observer() const { return observer_; }

  std::uint64_t* words() { return reinterpret_cast<std::uint64_t*>(strips_.data()); }
  const std::uint64_t* words() const { return reinterpret_cast<const std::uint64_t*>(strips_.data()); }

  /// @param offset_bytes a multiple of 8
  std::uint64_t* row(int offset_bytes) { return words() + std::size_t(offset_bytes / 8) * num_pes_; }
  const std::uint64_t* row(int offset_bytes) const {
    return words() + std::size_t(offset_bytes / 8) * num_pes_;
  }

 private:
  int num_pes_;
  int capacity_bytes_;
  std::vector<Buffer> buffers_;
  /// One word of a strip's PEs, on its own cache line: a vector that straddles two costs twice.
  struct alignas(64) StripOfWords {
    std::uint64_t word[8];
  };
  std::vector<StripOfWords> strips_;
  AccessObserver* observer_ = nullptr;
};

}  // namespace cn
