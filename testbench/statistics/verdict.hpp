#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "testbench/run/chip_statistics.hpp"

namespace testbench {

/// How much of the time a unit of the chip was busy.
struct UnitUse {
  std::string_view name;
  double share;  ///< of the firmware's time; of the host link, of the time with upload and download
};

/// Which unit held the run up.
struct Verdict {
  /// pe_array (kernels and the cycles stolen from them), pio (setup, turns of PEs, misalignment and waits for
  /// memory, not its bytes alone), clear_connect (bytes of a node's link), ddr (data bus), on_chip_sram
  /// (port), control_unit (everything but kernels and waits), host_link, and search_unit (queries in flight)
  /// if the chip has any; means of all arrays and chips.
  std::vector<UnitUse> units;
  std::string_view critical;  ///< the unit that was busy longest
  std::string reason;         ///< one line: how it spent its time, and who waited for it

  double share_of(std::string_view unit) const;
};

Verdict verdict_of(const ChipStatistics& statistics);

}  // namespace testbench
