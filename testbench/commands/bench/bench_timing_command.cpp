#include "testbench/commands/bench/bench_command.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/validation/timing_comparison.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

struct BenchTimingCommand {
  SceneArgument scene{"scenes/cornell_box"};
  FilmSize film{96, 96};
  ChipOptions chip;
  LevelOption level;
  int samples = 4;
  int jobs = 1;
  OutputFiles outputs;

  void run() const;

 private:
  std::vector<TimingComparison> measure(const Scene& loaded, const std::vector<TimingPoint>& points) const;
};

/// Cycles and the simulator's seconds of one run.
std::string run_point(const Scene& scene, RenderOptions options, model::TimingStyle timing) {
  options.timing = timing;
  const RenderResult result = render_on_chip(scene, options);
  return Json{{"cycles", result.chip->firmware_cycles}, {"cpu_seconds", result.cpu_seconds}}.dump();
}

std::vector<TimingComparison> BenchTimingCommand::measure(const Scene& loaded,
                                                          const std::vector<TimingPoint>& points) const {
  std::vector<std::function<std::string()>> runs;
  for (const TimingPoint& point : points)
    for (const auto timing : {model::TimingStyle::loosely_timed, model::TimingStyle::approximately_timed})
      runs.emplace_back([&loaded, &point, timing] { return run_point(loaded, point.options, timing); });
  ProgressBar bar("bench timing");
  const std::vector<std::string> results =
      run_in_processes(runs, jobs, [&](int finished) { bar.show(finished / double(runs.size())); });
  std::vector<TimingComparison> comparisons;
  for (std::size_t i = 0; i < results.size(); i += 2) {
    const Json loose = Json::parse(results[i]);
    const Json approximate = Json::parse(results[i + 1]);
    comparisons.push_back(
        {loose["cycles"], approximate["cycles"], loose["cpu_seconds"], approximate["cpu_seconds"]});
  }
  return comparisons;
}

void print_table(const std::vector<TimingPoint>& points, const std::vector<TimingComparison>& comparisons) {
  std::printf("  %-34s %14s %14s %9s %10s\n", "", "lt cycles", "at cycles", "lt error", "slower");
  double worst = 0;
  double sum = 0;
  double slowest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const TimingComparison& at = comparisons[i];
    const double slower = at.approximate_cpu_seconds / at.loose_cpu_seconds;
    std::printf("  %-34s %14llu %14llu %+8.3f%% %9.1fx\n", points[i].label.c_str(),
                static_cast<unsigned long long>(at.loose_cycles),
                static_cast<unsigned long long>(at.approximate_cycles), at.error_percent(), slower);
    worst = std::max(worst, std::abs(at.error_percent()));
    sum += std::abs(at.error_percent());
    slowest = std::max(slowest, slower);
  }
  std::printf(
      "Error of lt: %.3f %% mean, %.3f %% worst of %zu; at takes up to %.0f times lt's simulator time\n",
      sum / double(points.size()), worst, points.size(), slowest);
}

Json to_json(const std::vector<TimingPoint>& points, const std::vector<TimingComparison>& comparisons) {
  Json json;
  json["format"] = "csx600-bench-timing-1";
  json["points"] = Json::array();
  for (std::size_t i = 0; i < points.size(); ++i)
    json["points"].push_back({{"point", points[i].label},
                              {"lt_cycles", comparisons[i].loose_cycles},
                              {"at_cycles", comparisons[i].approximate_cycles},
                              {"lt_error_percent", comparisons[i].error_percent()}});
  return json;
}

void BenchTimingCommand::run() const {
  outputs.require_writable();
  RenderOptions options;
  options.chip = chip.chip();
  options.level = level.level();
  options.work.samples = samples;
  Scene loaded = scene.load();
  outputs.require_no_input(inputs_of(chip, loaded));
  loaded.film = film;
  const std::vector<TimingPoint> points = timing_points(options);
  const std::vector<TimingComparison> comparisons = measure(loaded, points);
  std::printf("%s at %d x %d, %d samples a pixel; chip %s; sweeps: program full, n = 1\n\n",
              loaded.name.c_str(), film.width, film.height, samples, options.chip.preset.c_str());
  print_table(points, comparisons);
  print_notes(loaded.notes);
  outputs.write("--json", [&] { return json_text(to_json(points, comparisons), 2) + "\n"; });
}

}  // namespace

void add_bench_timing_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "timing", "Compare loosely timed cycles with approximately timed ones, on a film of 96 x 96");
  const auto state = std::make_shared<BenchTimingCommand>();
  state->scene.add_to(command);
  state->chip.add_to(command, "paper");
  state->level.add_to(command);
  add_samples_option(command, state->samples);
  add_jobs_option(command, state->jobs);
  state->outputs.add_to(command, "--json", "Also write the points to this file, without simulator times");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
