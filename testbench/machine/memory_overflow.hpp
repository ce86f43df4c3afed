#pragma once

#include <string>

#include "firmware/cn/chip/poly_memory.hpp"
#include "testbench/system/error.hpp"

namespace testbench {

/// Firmware that does not fit the SRAM of a PE, as an error of the input; its details are the SRAM's map.
inline InputError input_error_of(const cn::PolyMemoryOverflow& error) {
  const std::string map = error.map().substr(0, error.map().find_last_not_of('\n') + 1);
  return InputError(std::string(error.what()) + "; buffers of a PE:", map);
}

}  // namespace testbench
