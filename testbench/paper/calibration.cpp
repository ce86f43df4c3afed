#include "testbench/paper/calibration.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <glm/glm.hpp>

#include "model/config/chip_parameters.hpp"

namespace testbench {
namespace {

constexpr int kMaxIterations = 8;
/// Largest relative error of a fitted cell at which the fit ends. One cycle per PE changes the unbuffered
/// cell by 0.7 %.
constexpr double kConverged = 0.004;

/// Step of each constant, the unit of the fit's vector.
constexpr double kSteps[3] = {0.5, 4, 400};

FittedConstants constants_at(const glm::dvec3& x) {
  return {std::max(0.05, x[0] * kSteps[0]), std::max(0.0, std::round(x[1] * kSteps[1])),
          std::max(0.0, std::round(x[2] * kSteps[2]))};
}

glm::dvec3 point_of(const FittedConstants& constants) {
  return {constants.code_quality_factor / kSteps[0], constants.per_pe_cycles / kSteps[1],
          constants.transfer_call_cycles / kSteps[2]};
}

class Fit {
 public:
  Fit(const Assumptions& assumptions, const CalibrationOptions& options)
      : assumptions_(assumptions), options_(options), cells_(fitted_cells()) {
    if (!assumptions.fits_transfer_call) cells_.pop_back();
  }

  glm::length_t unknowns() const { return static_cast<glm::length_t>(cells_.size()); }

  std::vector<double> seconds(const FittedConstants& constants, const std::vector<PaperCell>& cells) const {
    RenderOptions run;
    run.chip = assumptions_.chip;
    apply(constants, run.chip);
    run.program = assumptions_.program;
    run.work.samples = options_.samples;
    run.level = options_.level;
    return run_paper_cells(assumptions_.scene, run, cells, options_.at_once);
  }

  /// Relative errors of the fitted cells; 0 for a cell that is not fitted.
  glm::dvec3 residual(const glm::dvec3& x) const {
    const std::vector<double> found = seconds(constants_at(x), cells_);
    glm::dvec3 errors(0.0);
    for (glm::length_t i = 0; i < unknowns(); ++i)
      errors[i] = found[std::size_t(i)] / cells_[std::size_t(i)].seconds() - 1;
    return errors;
  }

  /// The Jacobian by differences, one column per unknown. The column of a constant that is not fitted is that
  /// of the unit matrix, which leaves it unchanged.
  glm::dmat3 jacobian(const glm::dvec3& x, const glm::dvec3& residual_at_x) const {
    glm::dmat3 matrix(1.0);
    for (glm::length_t i = 0; i < unknowns(); ++i) {
      glm::dvec3 moved = x;
      moved[i] += 1.0;
      matrix[i] = residual(moved) - residual_at_x;
    }
    return matrix;
  }

 private:
  const Assumptions& assumptions_;
  const CalibrationOptions& options_;
  std::vector<PaperCell> cells_;
};

std::string describe(const FittedConstants& constants, const glm::dvec3& errors) {
  char line[160];
  std::snprintf(line, sizeof(line),
                "code quality %.4f, %g cycles a PE, %g cycles a call: errors %+.2f %% %+.2f %% %+.2f %%",
                constants.code_quality_factor, constants.per_pe_cycles, constants.transfer_call_cycles,
                100 * errors[0], 100 * errors[1], 100 * errors[2]);
  return line;
}

double largest(const glm::dvec3& errors) {
  return std::max({std::abs(errors[0]), std::abs(errors[1]), std::abs(errors[2])});
}

/// Newton's step, limited to half of each constant and at least to two steps.
glm::dvec3 newton_step(const glm::dmat3& jacobian, const glm::dvec3& errors, const glm::dvec3& x) {
  const glm::dvec3 step = -(glm::inverse(jacobian) * errors);
  const glm::dvec3 limit = glm::max(0.5 * glm::abs(x), glm::dvec3(2.0));
  return glm::clamp(step, -limit, limit);
}

}  // namespace

std::array<std::pair<const char*, std::string>, 3> FittedConstants::settings() const {
  char factor[32];
  std::snprintf(factor, sizeof(factor), "%.4f", code_quality_factor);
  return {{{"poly.code_quality_factor", factor},
           {"pio.per_pe_cycles", std::to_string(std::lround(per_pe_cycles))},
           {"control.transfer_call_cycles", std::to_string(std::lround(transfer_call_cycles))}}};
}

void apply(const FittedConstants& constants, model::ChipConfig& chip) {
  for (const auto& [key, value] : constants.settings()) model::set_parameter(chip, key, value, "calibrate");
}

Calibration calibrate(const Assumptions& assumptions, const CalibrationOptions& options,
                      const std::function<void(const std::string&)>& progress) {
  const Fit fit(assumptions, options);
  const model::ChipConfig& chip = assumptions.chip;
  glm::dvec3 x = point_of({chip.poly.code_quality_factor, double(chip.pio.per_pe_cycles),
                           double(chip.control.transfer_call_cycles)});
  glm::dvec3 errors = fit.residual(x);
  Calibration result;
  while (true) {
    if (progress) progress(describe(constants_at(x), errors));
    if (largest(errors) < kConverged || result.iterations == kMaxIterations) break;
    x = point_of(constants_at(x + newton_step(fit.jacobian(x, errors), errors, x)));
    errors = fit.residual(x);
    ++result.iterations;
  }
  result.converged = largest(errors) < kConverged;
  result.constants = constants_at(x);
  result.seconds = fit.seconds(result.constants, paper_cells());
  const PredictionError error = prediction_error(result.seconds);
  result.mean_error = error.mean;
  result.worst_error = error.worst;
  return result;
}

std::string paper_constants_header(const FittedConstants& constants) {
  std::string text =
      "#pragma once\n\n"
      "// Written by `csx600 calibrate --write model/config/paper_constants.hpp`: the only numbers of the "
      "model "
      "that are\n"
      "// fitted to the paper's Tables 1 and 2, on three of their 24 cells.\n\n"
      "namespace model {\n\n";
  const char* names[] = {"kPaperCodeQualityFactor", "kPaperPerPeCycles", "kPaperTransferCallCycles"};
  std::size_t i = 0;
  for (const auto& [key, value] : constants.settings())
    text +=
        "// " + std::string(key) + "\ninline constexpr const char* " + names[i++] + " = \"" + value + "\";\n";
  return text + "\n}  // namespace model\n";
}

}  // namespace testbench
