#pragma once

#include <cstdint>
#include <string_view>

#include "testbench/system/error.hpp"

namespace testbench {

/// Appends a number with variable length: seven bits per byte, the lowest first; the top bit is set in all
/// bytes but the last.
template <class Bytes>  // a container with push_back()
void append_number(Bytes& bytes, std::uint64_t number) {
  using Byte = typename Bytes::value_type;
  for (; number >= 0x80; number >>= 7) bytes.push_back(static_cast<Byte>(number | 0x80));
  bytes.push_back(static_cast<Byte>(number));
}

/// Reads numbers and texts of a stream. Throws RunError at the end of the bytes.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : next_(bytes.data()), end_(bytes.data() + bytes.size()) {}

  bool at_end() const { return next_ == end_; }
  std::uint8_t byte() {
    if (at_end()) throw RunError("a recorded stream ends in the middle");
    return static_cast<std::uint8_t>(*next_++);
  }
  std::uint64_t number() {
    std::uint64_t value = 0;
    for (int shift = 0;; shift += 7) {
      const std::uint8_t next = byte();
      value |= std::uint64_t{next & 0x7fu} << shift;
      if ((next & 0x80) == 0) return value;
    }
  }
  std::string_view text(std::uint64_t bytes) {
    if (bytes > std::uint64_t(end_ - next_)) throw RunError("a recorded stream ends in the middle");
    const std::string_view found(next_, bytes);
    next_ += bytes;
    return found;
  }

 private:
  const char* next_;
  const char* end_;
};

}  // namespace testbench
