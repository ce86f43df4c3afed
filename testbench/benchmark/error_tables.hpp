#pragma once

#include <string>
#include <vector>

#include "testbench/benchmark/error_run.hpp"
#include "testbench/film/chart.hpp"

namespace testbench {

/// What tells curve `index` from the others: its scene, and the options in which any two of them differ.
std::string curve_label(const std::vector<ErrorCurve>& curves, std::size_t index);

/// One curve for people: a row for each number of samples, then slopes and C = MSE x time.
std::string curve_table(const ErrorCurve& curve);

/// A row for each curve at its largest number of samples. "" for a single curve.
std::string comparison_table(const std::vector<ErrorCurve>& curves);

/// Every point of every curve. Columns: the scene, the options of options_of_curves(), samples, errors, what
/// they took, and costs (MSE x what it took). What was not measured is empty.
std::string curves_csv(const std::vector<ErrorCurve>& curves);

/// RMSE over seconds, natively and, where measured, with timing on and simulated.
LogChart error_chart(const std::vector<ErrorCurve>& curves);

}  // namespace testbench
