#pragma once

#include <algorithm>

#include "firmware/cn/language/poly.hpp"

namespace cn {

/// The control unit learns the least `value` that an enabled PE holds. It knows of PEs no more than whether
/// any of them meets a condition, so it asks bit by bit, from the highest: has one of the PEs that are left a
/// zero there? If so, those with a one drop out.
///
/// Strips are executed one after the other, so the bits are not walked; what that takes is charged.
/// @param value 0 to 2^bits - 1
/// @param least lowered to what this strip holds; largest possible before the kernel
inline void keep_least(const poly<std::int32_t>& value, int bits, std::int32_t& least) {
  const auto times = static_cast<std::uint64_t>(bits);
  issue(InstructionClass::int32_alu, times);  // test of the bit
  issue(InstructionClass::enable, 2 * times);
  issue(InstructionClass::reduce, times);
  issue(InstructionClass::mono, 3 * times);
  for (std::uint32_t lanes = mask_bits(strip.enabled); lanes != 0; lanes &= lanes - 1)
    least = std::min(least, static_cast<std::int32_t>(value.lanes()[__builtin_ctz(lanes)]));
}

}  // namespace cn
