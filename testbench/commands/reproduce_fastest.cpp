#include "testbench/commands/reproduce_fastest.hpp"

#include <cmath>
#include <cstdio>

#include "testbench/paper/paper.hpp"

namespace testbench {
namespace {

double paper_segments_per_second() {
  return silicon_segments_per_second(path_tracer::Program::full);
}

template <class... Values>
std::string formatted(const char* format, Values... values) {
  char text[200];
  std::snprintf(text, sizeof(text), format, values...);
  return text;
}

}  // namespace

std::string fastest_text(const std::vector<FastestFigures>& figures, const ImageDistance& distance) {
  std::string text = formatted("%-20s %12s %8s %8s   %s\n", "", "segments/s", "factor", "in all",
                               "cycles a segment: kernels, calls of copies, waits, others; PIO beside them");
  text += formatted("%-20s %12.0f %8s %8.2f\n", "the paper", paper_segments_per_second(), "", 1.0);
  double before = paper_segments_per_second();
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const FastestFigures& of = figures[i];
    text += formatted("%-20s %12.0f %8.2f %8.2f   %7.1f %7.1f %7.1f %7.1f; %7.1f\n", fastest_steps()[i].name,
                      of.segments_per_second, of.segments_per_second / before,
                      of.segments_per_second / paper_segments_per_second(), of.kernels, of.calls, of.waits,
                      of.others, of.pio);
    before = of.segments_per_second;
  }
  text += "\n";
  for (const FastestStep& step : fastest_steps()) text += formatted("%-20s %s\n", step.name, step.change);
  text += formatted(
      "\nFirst and last step: %s; their pixels differ by at most %.1e of the brightest\n",
      distance.has_equal_counts ? "equally many segments and shadow rays" : "other segments or shadow rays",
      distance.largest_difference);
  return text;
}

nlohmann::ordered_json fastest_json(const std::vector<FastestFigures>& figures, const ImageDistance& distance,
                                    const RenderOptions& options) {
  nlohmann::ordered_json json;
  json["format"] = "csx600-fastest-1";
  json["chip_preset"] = options.chip.preset;
  json["samples"] = options.work.samples;
  json["paper_segments_per_second"] = paper_segments_per_second();
  json["steps"] = nlohmann::ordered_json::array();
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const FastestFigures& of = figures[i];
    json["steps"].push_back({{"step", fastest_steps()[i].name},
                             {"change", fastest_steps()[i].change},
                             {"segments_per_second", of.segments_per_second},
                             {"kernel_cycles_per_segment", of.kernels},
                             {"transfer_call_cycles_per_segment", of.calls},
                             {"wait_cycles_per_segment", of.waits},
                             {"other_cycles_per_segment", of.others},
                             {"pio_busy_cycles_per_segment", of.pio}});
  }
  json["image"] = {{"equal_counts", distance.has_equal_counts},
                   {"largest_difference", distance.largest_difference}};
  return json;
}

BarChart fastest_chart(const std::vector<FastestFigures>& figures) {
  BarChart chart{"The fastest full path tracer of the Cornell box on the paper's chip",
                 "path segments a second",
                 {{"the paper", std::round(paper_segments_per_second())}}};
  double before = paper_segments_per_second();
  for (std::size_t i = 0; i < figures.size(); ++i) {
    chart.bars.push_back(
        {fastest_steps()[i].name + formatted("\nx %.2f", figures[i].segments_per_second / before),
         figures[i].segments_per_second});
    before = figures[i].segments_per_second;
  }
  return chart;
}

}  // namespace testbench
