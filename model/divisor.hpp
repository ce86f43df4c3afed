#pragma once

#include <cstdint>

namespace model {

/// Division by a number that is fixed when the chip is built. Page, packet and bank counts are powers of two
/// in every real memory, for which a shift is five times faster than the host's divider; any other number
/// works too.
class Divisor {
 public:
  explicit Divisor(std::uint64_t value)
      : value_(value), shift_((value & (value - 1)) == 0 ? __builtin_ctzll(value) : -1) {}

  std::uint64_t value() const { return value_; }
  std::uint64_t quotient(std::uint64_t dividend) const {
    return shift_ >= 0 ? dividend >> shift_ : dividend / value_;
  }
  std::uint64_t remainder(std::uint64_t dividend) const {
    return shift_ >= 0 ? dividend & (value_ - 1) : dividend % value_;
  }

 private:
  std::uint64_t value_;
  int shift_;
};

}  // namespace model
