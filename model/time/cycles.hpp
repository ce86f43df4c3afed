#pragma once

#include <cstdint>

namespace model {

/// Chip time: whole cycles since the start. Declared apart from clock_domain.hpp, so that plain timing
/// classes need no SystemC.
using Cycles = std::uint64_t;

/// Whole cycles that `amount` takes at `per_cycle`.
constexpr Cycles cycles_for(std::uint64_t amount, std::uint64_t per_cycle) {
  return (amount + per_cycle - 1) / per_cycle;
}

}  // namespace model
