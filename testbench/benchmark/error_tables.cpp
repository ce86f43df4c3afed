#include "testbench/benchmark/error_tables.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "testbench/benchmark/formatted.hpp"
#include "testbench/files/csv.hpp"
#include "testbench/system/message_text.hpp"

namespace testbench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

double samples(const CurvePoint& point) {
  return point.samples;
}
double rmse(const CurvePoint& point) {
  return point.error.mse > 0 ? std::sqrt(point.error.mse) : kNone;
}
double native_seconds(const CurvePoint& point) {
  return point.native_cpu_seconds;
}
double timed_seconds(const CurvePoint& point) {
  return point.timed_cpu_seconds.value_or(kNone);
}
double simulated_seconds(const CurvePoint& point) {
  return point.simulated_seconds.value_or(kNone);
}
double joules(const CurvePoint& point) {
  return point.joules.value_or(kNone);
}
/// MSE times what the image took.
template <double taken(const CurvePoint&)>
double cost(const CurvePoint& point) {
  return cost_of_error(point.error, taken(point));
}

using Value = double (*)(const CurvePoint&);

/// A value of every point.
std::vector<double> column(const std::vector<CurvePoint>& points, Value value) {
  std::vector<double> values;
  for (const CurvePoint& point : points) values.push_back(value(point));
  return values;
}

double slope(const ErrorCurve& curve, Value x) {
  return log_log_slope(column(curve.points, x), column(curve.points, rmse));
}

bool is_timed(const CurvePoint& point) {
  return point.timed_cpu_seconds.has_value();
}

/// The last point with timing on; null if there is none.
const CurvePoint* last_timed(const ErrorCurve& curve) {
  const auto found = std::find_if(curve.points.rbegin(), curve.points.rend(), is_timed);
  return found == curve.points.rend() ? nullptr : &*found;
}

std::string row(const CurvePoint& point, bool with_timing) {
  const double* const bias = point.error.mean_bias;
  std::string text =
      formatted("%8d %10.6f %10.3e %7.4f %+8.3f%+8.3f%+8.3f %10.3f %10.3e", point.samples, rmse(point),
                point.error.relative_mse, point.error.flip, 100 * bias[0], 100 * bias[1], 100 * bias[2],
                native_seconds(point), cost<native_seconds>(point));
  if (with_timing && is_timed(point))
    text += formatted(" %10.3f %10.3e %12.3f %10.3f", timed_seconds(point), cost<timed_seconds>(point),
                      simulated_seconds(point), joules(point));
  return text + "\n";
}

std::string summary(const ErrorCurve& curve) {
  std::string text = formatted("slope of log RMSE over log samples %.3f, over log native CPU seconds %.3f",
                               slope(curve, samples), slope(curve, native_seconds));
  const CurvePoint* const timed = last_timed(curve);
  if (timed != nullptr)
    text += formatted(", over log timed CPU seconds %.3f, over log simulated seconds %.3f",
                      slope(curve, timed_seconds), slope(curve, simulated_seconds));
  const CurvePoint& last = curve.points.back();
  text += formatted("\nC = MSE x CPU seconds at %d samples: %.3e native", last.samples,
                    cost<native_seconds>(last));
  if (timed != nullptr)
    text += formatted("\nat %d samples: %.3e with timing on, MSE x simulated seconds %.3e, MSE x joules %.3e",
                      timed->samples, cost<timed_seconds>(*timed), cost<simulated_seconds>(*timed),
                      cost<joules>(*timed));
  return text + "\n";
}

std::string option_value(const ErrorCurve& curve, const path_tracer::ProgramOption& option) {
  return path_tracer::value_text(option.read(curve.program));
}

bool differs(const std::vector<ErrorCurve>& curves, const path_tracer::ProgramOption& option) {
  return std::any_of(curves.begin(), curves.end(), [&](const ErrorCurve& curve) {
    return option_value(curve, option) != option_value(curves.front(), option);
  });
}

/// What the CSV has of a point.
struct CsvColumn {
  const char* name;
  Value value;
};

const std::vector<CsvColumn>& csv_columns() {
  static const std::vector<CsvColumn> columns = {
      {"samples", samples},
      {"rmse", rmse},
      {"mse", [](const CurvePoint& point) { return point.error.mse; }},
      {"relative_mse", [](const CurvePoint& point) { return point.error.relative_mse; }},
      {"flip", [](const CurvePoint& point) { return point.error.flip; }},
      {"mean_bias_r", [](const CurvePoint& point) { return point.error.mean_bias[0]; }},
      {"mean_bias_g", [](const CurvePoint& point) { return point.error.mean_bias[1]; }},
      {"mean_bias_b", [](const CurvePoint& point) { return point.error.mean_bias[2]; }},
      {"native_cpu_seconds", native_seconds},
      {"timed_cpu_seconds", timed_seconds},
      {"simulated_seconds", simulated_seconds},
      {"joules", joules},
      {"native_mse_seconds", cost<native_seconds>},
      {"timed_mse_seconds", cost<timed_seconds>},
      {"simulated_mse_seconds", cost<simulated_seconds>},
      {"mse_joules", cost<joules>}};
  return columns;
}

}  // namespace

std::string curve_label(const std::vector<ErrorCurve>& curves, std::size_t index) {
  std::string label = printable(curves[index].scene);
  for (const path_tracer::ProgramOption* const option : options_of_curves())
    if (differs(curves, *option)) label += ", " + option->name + " " + option_value(curves[index], *option);
  return label;
}

std::string curve_table(const ErrorCurve& curve) {
  const bool with_timing = last_timed(curve) != nullptr;
  std::string text = formatted("%8s %10s %10s %7s %24s %10s %10s", "samples", "RMSE", "rel. MSE", "FLIP",
                               "mean bias R, G, B, %", "native s", "native C");
  if (with_timing) text += formatted(" %10s %10s %12s %10s", "timed s", "timed C", "simulated s", "joules");
  text += "\n";
  for (const CurvePoint& point : curve.points) text += row(point, with_timing);
  return text + summary(curve);
}

std::string comparison_table(const std::vector<ErrorCurve>& curves) {
  if (curves.size() < 2) return "";
  std::size_t width = 0;
  for (std::size_t i = 0; i < curves.size(); ++i) width = std::max(width, curve_label(curves, i).size());
  std::string text = std::string(width, ' ') +
                     formatted(" %8s %10s %10s %7s %7s %10s %10s %12s %12s\n", "samples", "RMSE", "rel. MSE",
                               "FLIP", "slope", "native s", "native C", "simulated C", "MSE x joules");
  for (std::size_t i = 0; i < curves.size(); ++i) {
    std::string label = curve_label(curves, i);
    label.resize(width, ' ');
    const CurvePoint& last = curves[i].points.back();
    text += label + formatted(" %8d %10.6f %10.3e %7.4f %7.3f %10.3f %10.3e", last.samples, rmse(last),
                              last.error.relative_mse, last.error.flip, slope(curves[i], samples),
                              native_seconds(last), cost<native_seconds>(last));
    if (const CurvePoint* const timed = last_timed(curves[i]))
      text += formatted(" %12.3e %12.3e", cost<simulated_seconds>(*timed), cost<joules>(*timed));
    text += "\n";
  }
  return text;
}

std::string curves_csv(const std::vector<ErrorCurve>& curves) {
  std::ostringstream csv;
  csv.precision(17);
  csv << "scene";
  for (const path_tracer::ProgramOption* const option : options_of_curves()) csv << ',' << option->name;
  for (const CsvColumn& column : csv_columns()) csv << ',' << column.name;
  csv << '\n';
  for (const ErrorCurve& curve : curves) {
    std::string keys = csv_text(curve.scene);
    for (const path_tracer::ProgramOption* const option : options_of_curves())
      keys += "," + csv_text(option_value(curve, *option));
    for (const CurvePoint& point : curve.points) {
      csv << keys;
      for (const CsvColumn& column : csv_columns()) {
        const double value = column.value(point);
        csv << ',';
        if (value == value) csv << value;  // empty where there is no value
      }
      csv << '\n';
    }
  }
  return csv.str();
}

LogChart error_chart(const std::vector<ErrorCurve>& curves) {
  LogChart chart{"Error against time", "seconds", "RMSE", {}};
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const std::vector<CurvePoint>& points = curves[i].points;
    const std::vector<double> errors = column(points, rmse);
    const std::string label = curve_label(curves, i);
    chart.series.push_back({label + ": native, CPU time", column(points, native_seconds), errors});
    if (last_timed(curves[i]) == nullptr) continue;
    chart.series.push_back({label + ": timing on, CPU time", column(points, timed_seconds), errors});
    chart.series.push_back({label + ": simulated time", column(points, simulated_seconds), errors});
  }
  return chart;
}

}  // namespace testbench
