#pragma once

#include <string>
#include <vector>

#include "testbench/run/chip_statistics.hpp"

namespace testbench {

/// First-order energy of a run, from the first cycle of the upload to the last of the download: counters
/// times the chip's table (`energy.*` of ChipConfig), scaled to the size of SRAMs, process and voltage
/// (technology.hpp). Computed after the run from what it counted.
struct Energy {
  struct Cause {
    std::string name;
    double joules;
    bool in_ddr;  ///< spent in the memory devices; all else is spent in the chip
  };
  std::vector<Cause> causes;  ///< those above zero among the instruction classes, and all others
  double seconds = 0;

  double chip_joules() const;
  double ddr_joules() const;
  /// The sum of the two.
  double joules() const { return chip_joules() + ddr_joules(); }
};

Energy energy_of(const ChipStatistics& statistics);

}  // namespace testbench
