#pragma once

#include <string>
#include <vector>

#include "testbench/run/render.hpp"

namespace testbench {

/// One render whose loosely timed cycles are compared with its approximately timed ones.
struct TimingPoint {
  std::string label;  ///< for example "full, n = 1" or "pio.per_pe_cycles = 60"
  RenderOptions options;
};

/// The three programs at n = 0, 1 and 2, then program full at n = 1 with one parameter changed at a time:
/// pio.per_pe_cycles, ddr.page_miss_cycles, clear_connect.bytes_per_cycle and chip.pes. All other options are
/// those of `base`.
std::vector<TimingPoint> timing_points(const RenderOptions& base);

struct TimingComparison {
  model::Cycles loose_cycles = 0;  ///< from the firmware's start to its end
  model::Cycles approximate_cycles = 0;
  double loose_cpu_seconds = 0;
  double approximate_cpu_seconds = 0;

  /// Error of the loosely timed run against the approximately timed one.
  double error_percent() const { return 100 * (double(loose_cycles) / double(approximate_cycles) - 1); }
};

}  // namespace testbench
