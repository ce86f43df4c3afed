#pragma once

#include <type_traits>

#include "firmware/cn/language/strip.hpp"

/// Shortcuts: results that the simulator finds in another way than the chip.
namespace cn {

/// Runs `body`; its instructions are charged elsewhere.
template <class Body>
inline auto without_charging(Body&& body) {
  const StripCounts before = strip.issued;
  if constexpr (std::is_void_v<decltype(body())>) {
    body();
    strip.issued = before;
  } else {
    auto result = body();
    strip.issued = before;
    return result;
  }
}

/// Runs `body` once and charges it `times` times. `body` enters no data-dependent region.
template <class Body>
inline void charge_times(std::uint64_t times, Body&& body) {
  const StripCounts before = strip.issued;
  body();
  for (std::size_t i = 0; i < kInstructionClasses; ++i)
    strip.issued.by_class[i] = before.by_class[i] + times * (strip.issued.by_class[i] - before.by_class[i]);
}

/// Whether an earlier strip has charged the current node, so that this strip need not.
inline bool is_charged() {
  return strip.node->reached;
}

/// The one hook for shortcuts. The simulator may find a result in another way than the PEs do, if the result
/// is the same to the bit. The charge is that of the Cn code, which does not run.
/// @param charge charges what the Cn code issues
/// @param shortcut returns the result
template <class Charge, class Shortcut>
inline auto found_another_way(Charge&& charge, Shortcut&& shortcut) {
  charge();
  return without_charging(shortcut);
}

}  // namespace cn
