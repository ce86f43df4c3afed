#pragma once

#include <cstdint>
#include <string>

namespace testbench {

/// Throws RunError, one line that begins with "out of memory", when the operating system cannot give this
/// process `bytes` more. Linux grants memory that it does not have, and kills the process that then uses it.
/// @param what needs it: "a film of 16384x16384 pixels"
void require_memory(std::uint64_t bytes, const std::string& what);

}  // namespace testbench
