#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "testbench/paper/paper_runs.hpp"

namespace testbench {

/// The constants that may be fitted to the paper's tables, as parameters of the chip.
struct FittedConstants {
  double code_quality_factor;   ///< poly.code_quality_factor: how much slower unoptimised Cn is than the cost
                                ///< table
  double per_pe_cycles;         ///< pio.per_pe_cycles: whole cycles
  double transfer_call_cycles;  ///< control.transfer_call_cycles: whole cycles

  /// Keys and values as --set reads them.
  std::array<std::pair<const char*, std::string>, 3> settings() const;
};

/// What the paper leaves open and a fit therefore assumes.
struct Assumptions {
  std::string name;
  model::ChipConfig chip;
  path_tracer::ProgramConfig program;
  Scene scene;
  int chips = 1;                   ///< that share the paper's work
  bool fits_transfer_call = true;  ///< otherwise it stays as `chip` has it and its cell is predicted
};

struct Calibration {
  FittedConstants constants;
  std::vector<double> seconds;  ///< of all 24 cells, predicted ones too
  double mean_error = 0;        ///< relative, of the cells that were not fitted
  double worst_error = 0;
  int iterations = 0;
  bool converged = false;  ///< the fitted cells are met within the step of a whole cycle
};

struct CalibrationOptions {
  int samples = 4;
  int at_once = 1;
  path_tracer::Level level = cn::widest_level();
};

/// Fits by Newton's method with differences, each constant to one cell of fitted_cells(), and predicts the
/// rest. Deterministic. `progress` is told what goes on, a line at a time.
Calibration calibrate(const Assumptions& assumptions, const CalibrationOptions& options,
                      const std::function<void(const std::string&)>& progress = {});

/// Sets the constants in a chip.
void apply(const FittedConstants& constants, model::ChipConfig& chip);

/// model/config/paper_constants.hpp with these constants.
std::string paper_constants_header(const FittedConstants& constants);

}  // namespace testbench
