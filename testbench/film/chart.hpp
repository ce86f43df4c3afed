#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace testbench {

/// One curve: points joined by lines.
struct ChartSeries {
  std::string label;
  std::vector<double> x;
  std::vector<double> y;
};

/// A chart with two logarithmic axes. Points that are not positive are left out.
struct LogChart {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::vector<ChartSeries> series;
};

struct ChartBar {
  std::string label;  ///< lines are separated by '\n'
  double value;
};

/// Bars side by side, with their values above them, on an axis that begins at 0.
struct BarChart {
  std::string title;
  std::string y_label;
  std::vector<ChartBar> bars;
};

/// Whether gnuplot is installed, which draws the charts.
bool can_draw_charts();

/// Draws the chart into an SVG file if the name ends in ".svg", else into a PNG file. Atomic. Throws as
/// write_atomically() does, and RunError if gnuplot fails.
void write_chart(const std::filesystem::path& path, const LogChart& chart);
void write_chart(const std::filesystem::path& path, const BarChart& chart);

}  // namespace testbench
