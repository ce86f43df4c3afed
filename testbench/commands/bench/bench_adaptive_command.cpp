#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <sstream>

#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/film/error_curve.hpp"
#include "testbench/film/light_pixels.hpp"
#include "testbench/mono_image/scene_features.hpp"
#include "testbench/passes/pass_render.hpp"
#include "testbench/sampling/adaptive_plan.hpp"
#include "testbench/system/progress_bar.hpp"

namespace testbench {
namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

/// Means over the runs of one way to sample.
struct SamplingPoint {
  double paths = 0;  ///< a pixel
  double seconds = 0;
  double mse = 0;
  double relative_mse = 0;
  double bias = 0;          ///< of the picture's mean
  double bias_squares = 0;  ///< mean of its square

  void add(const SamplingPoint& run, int runs) {
    paths += run.paths / runs;
    seconds += run.seconds / runs;
    mse += run.mse / runs;
    relative_mse += run.relative_mse / runs;
    bias += run.bias / runs;
    bias_squares += run.bias * run.bias / runs;
  }
};

struct BenchAdaptiveCommand {
  SceneArgument scene;
  std::string reference;
  std::vector<double> targets = {0.2, 0.1, 0.05};
  int samples = 4096;
  int runs = 4;
  bool native = false;
  RenderOptions options;
  ChipOptions chip;
  LevelOption level;
  FirmwareOptions firmware;
  OutputFiles outputs;

  void run();

 private:
  SamplingPoint measure(const Scene& loaded, const ExrFilm& truth, double target, int most) const;
  std::vector<SamplingPoint> uniform_curve(const Scene& loaded, const ExrFilm& truth, double least_mse,
                                           double least_relative_mse) const;
};

SamplingPoint point_of(const PassRender& render, const ExrFilm& truth, const std::vector<bool>& counts) {
  const ImageError error = image_error(render.film, truth, counts);
  const double bias = (error.mean_bias[0] + error.mean_bias[1] + error.mean_bias[2]) / 3;
  return {render.film.samples().mean,
          render.simulated_seconds.value_or(kNoValue),
          error.mse,
          error.relative_mse,
          bias,
          bias * bias};
}

/// @param target of adaptive sampling; 0: uniform samples
/// @param most samples of a pixel
SamplingPoint BenchAdaptiveCommand::measure(const Scene& loaded, const ExrFilm& truth, double target,
                                            int most) const {
  std::vector<bool> counts = light_pixels(loaded);
  counts.flip();
  const std::vector<double> importance(counts.size(), 1.0);
  Ranks alone;
  SamplingPoint mean;
  for (int run = 0; run < runs; ++run) {
    RenderRequest request{scene.path(), options, native};
    request.options.program.seed += std::uint64_t(run);
    const std::unique_ptr<SamplePlan> plan = [&]() -> std::unique_ptr<SamplePlan> {
      if (target > 0) return std::make_unique<AdaptivePlan>(importance, most, target);
      return std::make_unique<ShapedPlan>(importance, most);
    }();
    mean.add(point_of(*render_in_passes(alone, loaded, request, *plan, std::nullopt, {}), truth, counts),
             runs);
  }
  return mean;
}

/// 1, 2, 4, ... samples until both errors are below the least.
std::vector<SamplingPoint> BenchAdaptiveCommand::uniform_curve(const Scene& loaded, const ExrFilm& truth,
                                                               double least_mse,
                                                               double least_relative_mse) const {
  std::vector<SamplingPoint> curve;
  for (int most = 1; most <= samples; most *= 2) {
    curve.push_back(measure(loaded, truth, 0, most));
    if (curve.back().mse < least_mse && curve.back().relative_mse < least_relative_mse) break;
  }
  return curve;
}

/// What the uniform curve takes for an error, log-log between its points; NaN beyond them.
double uniform_cost(const std::vector<SamplingPoint>& curve, double SamplingPoint::*error,
                    double SamplingPoint::*cost, double value) {
  for (std::size_t i = 1; i < curve.size(); ++i) {
    const double above = curve[i - 1].*error;
    const double below = curve[i].*error;
    if (!(below <= value && value <= above)) continue;
    const double share = std::log(above / value) / std::log(above / below);
    return std::exp((1 - share) * std::log(curve[i - 1].*cost) + share * std::log(curve[i].*cost));
  }
  return kNoValue;
}

using Row = std::vector<std::pair<std::string, double>>;

/// The columns of a row, by name. @param target NaN of uniform samples
Row row_of(double target, const SamplingPoint& point, const std::vector<SamplingPoint>& curve, int runs) {
  const auto gain = [&](double SamplingPoint::*error, double SamplingPoint::*cost) {
    return uniform_cost(curve, error, cost, point.*error) / (point.*cost);
  };
  const double scatter = std::sqrt(std::max(0.0, point.bias_squares - point.bias * point.bias));
  return {{"target_error", target},
          {"paths_a_pixel", point.paths},
          {"simulated_seconds", point.seconds},
          {"rmse", std::sqrt(point.mse)},
          {"relative_rmse", std::sqrt(point.relative_mse)},
          {"bias_percent", 100 * point.bias},
          {"bias_error_percent", runs > 1 ? 100 * scatter / std::sqrt(runs - 1) : kNoValue},
          {"paths_gain_by_rmse", gain(&SamplingPoint::mse, &SamplingPoint::paths)},
          {"paths_gain_by_relative_rmse", gain(&SamplingPoint::relative_mse, &SamplingPoint::paths)},
          {"time_gain_by_rmse", gain(&SamplingPoint::mse, &SamplingPoint::seconds)},
          {"time_gain_by_relative_rmse", gain(&SamplingPoint::relative_mse, &SamplingPoint::seconds)}};
}

std::string to_csv(const std::vector<Row>& rows) {
  std::ostringstream csv;
  csv.precision(6);
  for (std::size_t column = 0; column < rows.front().size(); ++column)
    csv << (column == 0 ? "" : ",") << rows.front()[column].first;
  for (const Row& row : rows)
    for (std::size_t column = 0; column < row.size(); ++column) {
      csv << (column == 0 ? "\n" : ",");
      if (row[column].second == row[column].second) csv << row[column].second;  // empty where there is none
    }
  return csv.str() + '\n';
}

double least(const std::vector<SamplingPoint>& points, double SamplingPoint::*error) {
  double least = std::numeric_limits<double>::infinity();
  for (const SamplingPoint& point : points) least = std::min(least, point.*error);
  return least;
}

void BenchAdaptiveCommand::run() {
  outputs.require_writable();
  options.chip = chip.chip();
  options.level = level.level();
  const ExrFilm truth = read_exr_film(reference);
  Scene loaded = scene.load();
  loaded.film = {truth.width, truth.height};
  std::vector<InputName> inputs = inputs_of(chip, loaded);
  inputs.emplace_back("--reference", reference);
  outputs.require_no_input(inputs);
  options.program = built_for(loaded, options.program);
  choose_tree(TriangleCount(loaded), options.chip, firmware.given(), options.program);
  options.light_survey =
      std::make_shared<const LightSurvey>(make_normal_light_survey(loaded, options.program.light_sampling));
  std::vector<SamplingPoint> points;
  ProgressBar bar("bench adaptive");
  for (const double target : targets) {
    points.push_back(measure(loaded, truth, target, samples));
    bar.show(0.5 * double(points.size()) / double(targets.size()));
  }
  const std::vector<SamplingPoint> curve = uniform_curve(loaded, truth, least(points, &SamplingPoint::mse),
                                                         least(points, &SamplingPoint::relative_mse));
  std::vector<Row> rows;
  for (const SamplingPoint& point : curve) rows.push_back(row_of(kNoValue, point, {}, runs));
  for (std::size_t i = 0; i < points.size(); ++i) rows.push_back(row_of(targets[i], points[i], curve, runs));
  print_notes(loaded.notes);
  std::fputs(to_csv(rows).c_str(), stdout);
  outputs.write("--csv", [&] { return to_csv(rows); });
}

}  // namespace

void add_bench_adaptive_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "adaptive",
      "Paths and simulated time that adaptive sampling saves against uniform samples at equal error");
  const auto state = std::make_shared<BenchAdaptiveCommand>();
  state->scene.add_to(command);
  command
      .add_option("--reference", state->reference, "File of `csx600 bench reference`; sets the film's size")
      ->type_name("FILE")
      ->required();
  command.add_option("--targets", state->targets, "Values of --target-error of `csx600 render`")
      ->delimiter(',')
      ->type_name("ERROR,...")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_samples_option(command, state->samples);
  in_range(command.add_option("--runs", state->runs, "Seeds to take the mean of"), 1, 1000)
      ->capture_default_str();
  command.add_flag("--native", state->native, "Without SystemC: paths only, no time");
  state->outputs.add_to(command, "--csv", "Write the table as CSV");
  state->options.program = path_tracer::default_program();
  state->firmware.add_to(command, state->options.program,
                         {path_tracer::OptionGroup::sampling, path_tracer::OptionGroup::tree});
  state->chip.add_to(command, "csx600");
  state->level.add_to(command);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
