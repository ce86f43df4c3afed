#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "testbench/sensitivity/variations.hpp"
#include "testbench/sweep/sweep_points.hpp"

namespace testbench {

/// What a run is judged by.
struct RunFigures {
  double cycles = 0;
  double seconds = 0;  ///< simulated
  double joules = 0;   ///< chip and DDR
};

/// A run on a changed chip.
struct VariedRun {
  Variation variation;
  RunFigures figures;
  std::string error;  ///< why it could not run, in a line; then there are no figures
};

struct Sensitivity {
  /// Of the run as it is, without the section `simulator`.
  std::shared_ptr<const nlohmann::ordered_json> statistics;
  RunFigures base;
  std::vector<VariedRun> runs;
  std::vector<LeftOut> left_out;
  double share = 0;
  int replayed = 0;  ///< the others ran in full
};

/// Runs the point once and then on every varied chip, each in a process of its own: by replaying the one
/// recording, or in full where the change may be seen by the firmware, or where a replay is not possible.
/// @param progress takes the share done
/// Throws InputError and RunError as run_point() does for the point itself.
Sensitivity measure_sensitivity(const SweepPoint& point, Variations variations, double share, int jobs,
                                const std::function<void(double share)>& progress);

}  // namespace testbench
