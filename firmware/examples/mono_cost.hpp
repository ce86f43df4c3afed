#pragma once

#include <cstdint>

namespace examples {

/// Instructions of the control unit for a transfer (assumed): four arguments, an address, the call and the
/// bookkeeping of a buffer.
inline constexpr std::uint64_t kRequestInstructions = 12;

}  // namespace examples
