#include "testbench/paper/fastest.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "model/config/chip_parameters.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::json;

RenderOptions options_of_step(const RenderOptions& base, std::size_t step) {
  RenderOptions options = base;
  for (std::size_t i = 0; i <= step; ++i) fastest_steps()[i].apply(options);
  return options;
}

std::string measure_step(const Scene& scene, const RenderOptions& options) {
  const RenderResult result = render_on_chip(scene, options);
  const ChipStatistics& chip = *result.chip;
  const auto segments = double(result.counts.segments);
  const Json json = Json::parse(to_json(chip).dump());
  const Json& cycles = json["control_unit"]["cycles_by_cause"];
  const auto sum = [&](std::initializer_list<const char*> causes) {
    double total = 0;
    for (const char* const cause : causes) total += cycles[cause].get<double>();
    return total / segments;
  };
  return Json{{"segments_per_second", segments / chip.seconds()},
              {"kernels", sum({"poly", "stolen"})},
              {"calls", sum({"transfer_call"})},
              {"waits", sum({"wait_load", "wait_save", "wait_pio_queue", "wait_host"})},
              {"others", sum({"mono", "data_cache", "semaphore", "thread_switch"})},
              {"pio", json["pio"]["busy_cycles"].get<double>() / segments}}
      .dump();
}

FastestFigures figures_of_step(const std::string& text) {
  const Json json = Json::parse(text);
  FastestFigures figures;
  figures.segments_per_second = json["segments_per_second"].get<double>();
  figures.kernels = json["kernels"].get<double>();
  figures.calls = json["calls"].get<double>();
  figures.waits = json["waits"].get<double>();
  figures.others = json["others"].get<double>();
  figures.pio = json["pio"].get<double>();
  return figures;
}

}  // namespace

const std::vector<FastestStep>& fastest_steps() {
  static const std::vector<FastestStep> steps = {
      {"the paper's program", "the model of Table 1, n = 1, full computation", [](RenderOptions&) {}},
      {"tuned code", "poly.code_quality_factor 1: the cost table as it is",
       [](RenderOptions& options) {
         model::set_parameter(options.chip, "poly.code_quality_factor", "1", "tuned code");
       }},
      {"no bins", "resident_paths 1: path and scene stay in each PE's SRAM",
       [](RenderOptions& options) { options.program.resident_paths = 1; }},
      {"vectors", "resident_paths 4: vector instructions search for four rays of a PE",
       [](RenderOptions& options) { options.program.resident_paths = 4; }}};
  return steps;
}

std::vector<FastestFigures> measure_fastest(const Scene& scene, const RenderOptions& base, int at_once,
                                            const std::function<void(double)>& done) {
  std::vector<std::function<std::string()>> jobs;
  for (std::size_t step = 0; step < fastest_steps().size(); ++step)
    jobs.emplace_back(
        [&scene, options = options_of_step(base, step)] { return measure_step(scene, options); });
  const std::vector<std::string> results = run_in_processes(jobs, at_once, [&](int finished) {
    if (done) done(finished / double(jobs.size()));
  });
  std::vector<FastestFigures> figures;
  for (const std::string& result : results) figures.push_back(figures_of_step(result));
  return figures;
}

ImageDistance compare_first_and_last(const Scene& scene, const RenderOptions& base) {
  const RenderResult first = render_natively(scene, options_of_step(base, 0));
  const RenderResult last = render_natively(scene, options_of_step(base, fastest_steps().size() - 1));
  const std::vector<double> a = first.film.rgb();
  const std::vector<double> b = last.film.rgb();
  ImageDistance distance;
  double brightest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    brightest = std::max(brightest, a[i]);
    distance.largest_difference = std::max(distance.largest_difference, std::abs(a[i] - b[i]));
  }
  if (brightest > 0) distance.largest_difference /= brightest;
  distance.has_equal_counts =
      first.counts.segments == last.counts.segments && first.counts.shadow_rays == last.counts.shadow_rays;
  return distance;
}

}  // namespace testbench
