#pragma once

#include <string>

namespace testbench {

/// "0.1.0", from the CMake project.
std::string program_version();

/// What `csx600 --version` prints: the program's version, SystemC's, and the levels that kernels were built
/// for.
std::string version_text();

}  // namespace testbench
