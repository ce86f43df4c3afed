#pragma once

#include <cstdint>
#include <type_traits>

#include "firmware/cn/language/strip.hpp"

namespace cn {

/// How lanes hold a scalar type, and which instructions its operators are. Integers live in 64-bit lanes and
/// are wrapped to their range after each operation. So a mask fits every type but float without conversion.
template <class T>
struct PolyTraits;

template <>
struct PolyTraits<double> {
  using Lane = double;
  static constexpr auto kAdd = InstructionClass::fp64_add;
  static constexpr auto kMul = InstructionClass::fp64_mul;
  static constexpr auto kDiv = InstructionClass::fp64_div;
};
template <>
struct PolyTraits<float> {
  using Lane = float;
  static constexpr auto kAdd = InstructionClass::fp32_add;
  static constexpr auto kMul = InstructionClass::fp32_mul;
  static constexpr auto kDiv = InstructionClass::fp32_div;
};
template <>
struct PolyTraits<std::int16_t> {
  using Lane = std::int64_t;
  static constexpr auto kAdd = InstructionClass::int16_alu;
  static constexpr auto kMul = InstructionClass::int16_mul;
};
template <>
struct PolyTraits<std::int32_t> {
  using Lane = std::int64_t;
  static constexpr auto kAdd = InstructionClass::int32_alu;
  static constexpr auto kMul = InstructionClass::int32_mul;
};
template <>
struct PolyTraits<std::uint32_t> {
  using Lane = std::uint64_t;
  static constexpr auto kAdd = InstructionClass::int32_alu;
  static constexpr auto kMul = InstructionClass::int32_mul;
};
template <>
struct PolyTraits<std::int64_t> {
  using Lane = std::int64_t;
  static constexpr auto kAdd = InstructionClass::int64_alu;
  static constexpr auto kMul = InstructionClass::int64_mul;
};
template <>
struct PolyTraits<std::uint64_t> {
  using Lane = std::uint64_t;
  static constexpr auto kAdd = InstructionClass::int64_alu;
  static constexpr auto kMul = InstructionClass::int64_mul;
};

/// Wraps 64-bit lanes to the range of T, as the narrower machine type would.
template <class T>
inline Lanes<typename PolyTraits<T>::Lane> wrap_lanes(const Lanes<typename PolyTraits<T>::Lane>& value) {
  using Lane = typename PolyTraits<T>::Lane;
  if constexpr (std::is_floating_point_v<T> || sizeof(T) == 8) {
    return value;
  } else {
    constexpr Lane kLowBits = static_cast<Lane>((std::uint64_t{1} << (8 * sizeof(T))) - 1);
    constexpr Lane kSignBit = std::is_signed_v<T> ? Lane{1} << (8 * sizeof(T) - 1) : Lane{0};
    return each_chunk<Lane>([&](int i) { return ((value.chunk[i] & kLowBits) ^ kSignBit) - kSignBit; });
  }
}

/// One condition for each PE. Combining conditions works on the enable bits' test register, a 16-bit
/// operation.
class mask {
 public:
  mask() = default;
  explicit mask(const MaskLanes& lanes) : lanes_(lanes) {}

  const MaskLanes& lanes() const { return lanes_; }

  friend mask operator&(const mask& a, const mask& b) {
    issue(InstructionClass::int16_alu);
    return mask(a.lanes_ & b.lanes_);
  }
  friend mask operator|(const mask& a, const mask& b) {
    issue(InstructionClass::int16_alu);
    return mask(a.lanes_ | b.lanes_);
  }
  friend mask operator!(const mask& a) {
    issue(InstructionClass::int16_alu);
    return mask(~a.lanes_);
  }

 private:
  MaskLanes lanes_;
};

/// A Cn poly variable: one T for each PE. Operators compute all PEs of the strip and issue one instruction
/// each; a mono operand stays a scalar. Assignment to an existing variable changes enabled PEs only. A new
/// variable's disabled PEs are undefined.
template <class T>
class poly {
 public:
  using Traits = PolyTraits<T>;
  using Lane = typename Traits::Lane;

  poly() = default;
  poly(const poly&) = default;
  poly(T mono_value) : lanes_(broadcast(static_cast<Lane>(mono_value))) {}
  explicit poly(const Lanes<Lane>& lanes) : lanes_(lanes) {}

  poly& operator=(const poly& other) {
    issue(InstructionClass::move);
    lanes_ = select_lanes(strip.enabled, other.lanes_, lanes_);
    return *this;
  }

  /// Assigns in all PEs; charges no instruction, because a compiler would rename a register. For variables
  /// whose old value is never read again.
  void assign_all_lanes(const poly& other) { lanes_ = other.lanes_; }

  const Lanes<Lane>& lanes() const { return lanes_; }

  poly& operator+=(const poly& b) { return *this = *this + b; }
  poly& operator-=(const poly& b) { return *this = *this - b; }
  poly& operator*=(const poly& b) { return *this = *this * b; }

  friend poly operator+(const poly& a, const poly& b) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] + b.lanes_.chunk[i]; });
  }
  friend poly operator-(const poly& a, const poly& b) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] - b.lanes_.chunk[i]; });
  }
  friend poly operator*(const poly& a, const poly& b) {
    return binary(Traits::kMul, [&](int i) { return a.lanes_.chunk[i] * b.lanes_.chunk[i]; });
  }
  friend poly operator+(const poly& a, T b) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] + Lane(b); });
  }
  friend poly operator+(T a, const poly& b) { return b + a; }
  friend poly operator-(const poly& a, T b) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] - Lane(b); });
  }
  friend poly operator-(T a, const poly& b) {
    return binary(Traits::kAdd, [&](int i) { return Lane(a) - b.lanes_.chunk[i]; });
  }
  friend poly operator*(const poly& a, T b) {
    return binary(Traits::kMul, [&](int i) { return a.lanes_.chunk[i] * Lane(b); });
  }
  friend poly operator*(T a, const poly& b) { return b * a; }
  friend poly operator-(const poly& a) {
    return binary(Traits::kAdd, [&](int i) { return -a.lanes_.chunk[i]; });
  }

  friend poly operator/(const poly& a, const poly& b) {
    static_assert(std::is_floating_point_v<T>, "PEs have no integer divider");
    return binary(Traits::kDiv, [&](int i) { return a.lanes_.chunk[i] / b.lanes_.chunk[i]; });
  }
  friend poly operator/(const poly& a, T b) {
    static_assert(std::is_floating_point_v<T>, "PEs have no integer divider");
    return binary(Traits::kDiv, [&](int i) { return a.lanes_.chunk[i] / Lane(b); });
  }
  friend poly operator/(T a, const poly& b) {
    static_assert(std::is_floating_point_v<T>, "PEs have no integer divider");
    return binary(Traits::kDiv, [&](int i) { return Lane(a) / b.lanes_.chunk[i]; });
  }

  friend poly operator&(const poly& a, const poly& b) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] & b.lanes_.chunk[i]; });
  }
  friend poly operator|(const poly& a, const poly& b) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] | b.lanes_.chunk[i]; });
  }
  friend poly operator^(const poly& a, const poly& b) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] ^ b.lanes_.chunk[i]; });
  }
  friend poly operator>>(const poly& a, int bits) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] >> bits; });
  }
  friend poly operator<<(const poly& a, int bits) {
    return binary(Traits::kAdd, [&](int i) { return a.lanes_.chunk[i] << bits; });
  }

  friend mask operator<(const poly& a, const poly& b) { return compare<Comparison::less>(a, b); }
  friend mask operator<=(const poly& a, const poly& b) { return compare<Comparison::less_or_equal>(a, b); }
  friend mask operator==(const poly& a, const poly& b) { return compare<Comparison::equal>(a, b); }
  friend mask operator!=(const poly& a, const poly& b) { return compare<Comparison::not_equal>(a, b); }
  friend mask operator>(const poly& a, const poly& b) { return b < a; }
  friend mask operator>=(const poly& a, const poly& b) { return b <= a; }

 private:
  template <class F>
  static poly binary(InstructionClass instruction, F&& f) {
    issue(instruction);
    return poly(wrap_lanes<T>(each_chunk<Lane>(f)));
  }

  template <Comparison comparison>
  static mask compare(const poly& a, const poly& b) {
    issue(Traits::kAdd);
    return mask(compare_lanes<comparison>(a.lanes_, b.lanes_));
  }

  Lanes<Lane> lanes_;
};

/// Converts between number formats; float to integer truncates towards zero.
template <class To, class From>
inline poly<To> convert(const poly<From>& from) {
  using ToLane = typename poly<To>::Lane;
  issue(InstructionClass::convert);
  if constexpr (std::is_same_v<To, double> && std::is_same_v<From, std::uint32_t>) {
    // The integer is exact in the mantissa of 2^52. No vector extension before AVX-512 converts 64-bit lanes.
    constexpr std::uint64_t kTwoTo52Bits = 0x4330000000000000u;
    const auto biased = bit_cast_lanes<double>(
        each_chunk<std::uint64_t>([&](int i) { return from.lanes().chunk[i] | kTwoTo52Bits; }));
    return poly<double>(each_chunk<double>([&](int i) { return biased.chunk[i] - 0x1p52; }));
  } else if constexpr (std::is_same_v<To, float> && std::is_same_v<From, double>) {
    return poly<float>(narrow_lanes(from.lanes()));
  } else {
    // Narrow numbers go through the signed 64-bit format, whose conversion is one instruction at every x86-64
    // level. So all levels give the same bits, also out of range. The conversion to unsigned differs between
    // AVX-512 and the others.
    using Through =
        std::conditional_t<std::is_floating_point_v<From> && std::is_integral_v<To> && sizeof(To) < 8,
                           std::int64_t, ToLane>;
    using FromLane = typename poly<From>::Lane;
    constexpr bool is_one_instruction =
        (std::is_same_v<FromLane, std::int64_t> && std::is_same_v<ToLane, double>) ||
        (std::is_same_v<FromLane, double> && std::is_same_v<ToLane, std::int64_t>);
    if constexpr (is_one_instruction) {
      return poly<To>(wrap_lanes<To>(each_chunk<ToLane>([&](int i) {
        return __builtin_convertvector(from.lanes().chunk[i], typename Lanes<ToLane>::Chunk);
      })));
    } else {
      return poly<To>(wrap_lanes<To>(each_lane<ToLane>(
          [&](int i) { return static_cast<ToLane>(static_cast<Through>(from.lanes()[i])); })));
    }
  }
}

/// Reads the same 8 bytes as another type: naming a register differently costs nothing.
template <class To, class From>
inline poly<To> reinterpret(const poly<From>& from) {
  static_assert(sizeof(To) == 8 && sizeof(From) == 8);
  return poly<To>(bit_cast_lanes<typename poly<To>::Lane>(from.lanes()));
}

/// Reads the same 32-bit integer as signed or unsigned.
template <class To, class From>
inline poly<To> reinterpret_word(const poly<From>& from) {
  static_assert(sizeof(To) == 4 && std::is_integral_v<To> && sizeof(From) == 4 && std::is_integral_v<From>);
  return poly<To>(wrap_lanes<To>(bit_cast_lanes<typename poly<To>::Lane>(from.lanes())));
}

/// Returns `if_set` where the condition holds, else `otherwise`; all PEs compute both.
template <class T>
inline poly<T> select(const mask& condition, const poly<T>& if_set, const poly<T>& otherwise) {
  issue(InstructionClass::move);
  return poly<T>(select_lanes(condition.lanes(), if_set.lanes(), otherwise.lanes()));
}

/// The 64-bit product of two 32-bit numbers, as two words.
struct WideProduct {
  poly<std::uint32_t> high;
  poly<std::uint32_t> low;
};

inline WideProduct multiply_wide(const poly<std::uint32_t>& a, std::uint32_t b) {
  issue(InstructionClass::int32_mul);
  const auto product = multiply_low_words(a.lanes(), broadcast(std::uint64_t{b}));
  return {poly<std::uint32_t>(each_chunk<std::uint64_t>([&](int i) { return product.chunk[i] >> 32; })),
          poly<std::uint32_t>(wrap_lanes<std::uint32_t>(product))};
}

/// Joins two words to a number: two registers side by side.
inline poly<std::uint64_t> join_words(const WideProduct& words) {
  return poly<std::uint64_t>(each_chunk<std::uint64_t>(
      [&](int i) { return (words.high.lanes().chunk[i] << 32) | words.low.lanes().chunk[i]; }));
}

/// Returns this PE's number, 0 at the left end of the array.
inline poly<std::int32_t> pe_num() {
  issue(InstructionClass::sram);  // the ABI keeps it in the top 16 bytes of poly SRAM
  const std::int64_t first = strip.first_pe;
  return poly<std::int32_t>(each_lane<std::int64_t>([&](int i) { return first + i; }));
}

inline int num_pes() {
  return strip.num_pes;
}

}  // namespace cn
