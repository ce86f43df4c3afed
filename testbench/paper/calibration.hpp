#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "testbench/paper/paper_runs.hpp"

namespace testbench {

/// The constants that are fitted to the paper's tables; each is a parameter of the chip.
struct FittedConstants {
  double code_quality_factor;   ///< poly.code_quality_factor: how much slower unoptimised Cn is than the cost
                                ///< table
  double per_pe_cycles;         ///< pio.per_pe_cycles: whole cycles
  double transfer_call_cycles;  ///< control.transfer_call_cycles: whole cycles

  /// Keys and values in the form that --set reads.
  std::array<std::pair<const char*, std::string>, 3> settings() const;
};

/// Assumptions of a fit about what the paper leaves open.
struct Assumptions {
  std::string name;
  model::ChipConfig chip;
  path_tracer::ProgramConfig program;
  Scene scene;
  bool fits_transfer_call = true;  ///< false: it keeps the value of `chip`, and its cell is predicted
};

struct Calibration {
  FittedConstants constants;
  std::vector<double> seconds;  ///< seconds of all 24 cells, fitted and predicted
  double mean_error = 0;        ///< relative error of the predicted cells
  double worst_error = 0;
  int iterations = 0;
  bool converged = false;  ///< whether the fitted cells are met as closely as whole cycles allow
};

struct CalibrationOptions {
  int samples = 4;
  int at_once = 1;
  cn::Level level = cn::widest_level();
};

/// Fits each constant to one cell of fitted_cells(), by Newton's method with differences, and predicts the
/// other cells. Deterministic. `progress` receives one line per iteration.
Calibration calibrate(const Assumptions& assumptions, const CalibrationOptions& options,
                      const std::function<void(const std::string&)>& progress = {});

/// Sets the parameters of `chip` to the constants.
void apply(const FittedConstants& constants, model::ChipConfig& chip);

/// The text of model/config/paper_constants.hpp with these constants.
std::string paper_constants_header(const FittedConstants& constants);

}  // namespace testbench
