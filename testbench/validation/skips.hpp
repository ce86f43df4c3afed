#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "testbench/run/render.hpp"

namespace testbench {

/// How often something was skipped, out of how often it came up.
struct SkipCount {
  std::uint64_t skipped = 0;
  std::uint64_t all = 0;
};

/// Work that the firmware leaves out where a scene or a pass has no use for it.
struct Skip {
  std::string name;
  std::string switched_off_by;  ///< as on the command line
  void (*switch_off)(path_tracer::ProgramConfig& program);
  /// Whether the image without the skip is the same to the bit; otherwise to rounding.
  bool is_exact;
  SkipCount (*count)(const RenderResult& result);  ///< null: nothing counts it
};

/// The one list of skips.
const std::vector<Skip>& skip_table();

}  // namespace testbench
