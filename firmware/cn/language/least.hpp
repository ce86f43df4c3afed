#pragma once

#include <algorithm>

#include "firmware/cn/language/poly.hpp"
#include "firmware/cn/language/shortcut.hpp"

namespace cn {

/// Gives the control unit the least `value` of the enabled PEs. The control unit can only ask whether any PE
/// meets a condition, so it asks bit by bit from the highest: does one of the remaining PEs have a zero
/// there? If so, the PEs with a one drop out.
///
/// Strips are executed one after the other, so the simulator compares the values instead of their bits.
/// @param value 0 to 2^bits - 1
/// @param least lowered to the least value of this strip; before the kernel, the largest possible value
inline void keep_least(const poly<std::int32_t>& value, int bits, std::int32_t& least) {
  const auto charge = [&] {
    const auto times = static_cast<std::uint64_t>(bits);
    issue(InstructionClass::int32_alu, times);  // test of the bit
    issue(InstructionClass::enable, 2 * times);
    issue(InstructionClass::reduce, times);
    issue(InstructionClass::mono, 3 * times);
  };
  found_another_way(charge, [&] {
    for (std::uint32_t lanes = mask_bits(strip.enabled); lanes != 0; lanes &= lanes - 1)
      least = std::min(least, static_cast<std::int32_t>(value.lanes()[__builtin_ctz(lanes)]));
  });
}

}  // namespace cn
