#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace testbench {

/// Points joined by lines.
struct ChartSeries {
  std::string label;
  std::vector<double> x;
  std::vector<double> y;
};

/// Both axes logarithmic; points that are not positive are left out.
struct LogChart {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<ChartSeries> series;
};

/// Whether gnuplot, which draws the charts, is installed.
bool can_draw_charts();

/// Draws into a PNG or, by the name's ending, an SVG file. Atomic; throws InputError or RunError as
/// write_atomically() does, RunError when gnuplot fails.
void write_chart(const std::filesystem::path& path, const LogChart& chart);

}  // namespace testbench
