#include "testbench/commands/version.hpp"

#include <systemc>

#include "firmware/cn/simd/level.hpp"

namespace testbench {

std::string program_version() {
  return CSX600_VERSION;
}

std::string version_text() {
  std::string levels;
  for (const cn::Level level : cn::built_levels())
    levels += (levels.empty() ? "" : ", ") + std::string("x86-64-") + cn::name_of(level);
  return "csx600 " + program_version() + "\nSystemC " + sc_core::sc_release() + "\nkernels for " + levels;
}

}  // namespace testbench
