#pragma once

#include <cstdint>

namespace model {

/// Division by a number that is fixed when the chip is built. Page, packet and bank counts are powers of two
/// in every real memory, for which a shift is five times faster than the simulator's divider; any other
/// number works, too.
class Divisor {
 public:
  explicit Divisor(std::uint64_t value)
      : value_(value), shift_((value & (value - 1)) == 0 ? __builtin_ctzll(value) : -1) {}

  bool is_power_of_two() const { return shift_ >= 0; }
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

/// A Divisor that is known to be a power of two, for loops in which even the test for it costs too much.
class PowerOfTwo {
 public:
  explicit PowerOfTwo(const Divisor& divisor)
      : value_(divisor.value()), shift_(__builtin_ctzll(divisor.value())) {}

  std::uint64_t value() const { return value_; }
  std::uint64_t quotient(std::uint64_t dividend) const { return dividend >> shift_; }
  std::uint64_t remainder(std::uint64_t dividend) const { return dividend & (value_ - 1); }

 private:
  std::uint64_t value_;
  int shift_;
};

}  // namespace model
