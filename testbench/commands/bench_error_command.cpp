#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <sstream>

#include "testbench/commands/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/film/chart.hpp"
#include "testbench/film/error_curve.hpp"
#include "testbench/film/light_pixels.hpp"
#include "testbench/run/render_parts.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct BenchErrorCommand {
  SceneArgument scene;
  std::string reference;
  OutputFiles outputs;
  bool native_only = false;
  int samples = 1024;
  RenderOptions options;
  ChipOptions chip;
  LevelOption level;
  FirmwareOptions firmware;

  void run();

 private:
  void require_outputs() const;
  ExrFilm load_reference() const;
  Scene load(const ExrFilm& truth) const;
  std::vector<CurvePoint> measure(const Scene& loaded, const ExrFilm& truth) const;
};

void BenchErrorCommand::require_outputs() const {
  if ((samples & (samples - 1)) != 0)
    throw InputError("--samples: found " + std::to_string(samples) + ", allowed is a power of two");
  outputs.require_writable();
}

ExrFilm BenchErrorCommand::load_reference() const {
  ExrFilm truth = read_exr_film(reference);
  const auto seed = truth.attributes.find(kSeedAttribute);
  if (seed == truth.attributes.end())
    throw InputError(reference + ": found no attribute " + kSeedAttribute +
                     "; allowed: a file of `csx600 bench reference`");
  if (seed->second == std::to_string(options.program.seed))
    throw InputError("--seed: found " + seed->second + ", the reference's; allowed is any other");
  return truth;
}

Scene BenchErrorCommand::load(const ExrFilm& truth) const {
  Scene loaded = scene.load();
  const auto of_reference = truth.attributes.find("csx600.scene");
  if (of_reference == truth.attributes.end() || scene.load_other(of_reference->second).name != loaded.name)
    throw InputError(reference + ": found a reference of another scene; allowed is one of " + loaded.name);
  loaded.film = {truth.width, truth.height};
  return loaded;
}

/// 1, 1, 2, 4, ... samples: after part k there are 2^k.
std::vector<path_tracer::Work> doubling_parts(int samples) {
  std::vector<path_tracer::Work> parts{{0, 1}};
  for (int done = 1; done < samples; done *= 2) parts.push_back({done, done});
  return parts;
}

std::vector<CurvePoint> BenchErrorCommand::measure(const Scene& loaded, const ExrFilm& truth) const {
  std::vector<bool> counts = light_pixels(loaded);
  counts.flip();
  if (std::find(counts.begin(), counts.end(), true) == counts.end())
    throw InputError(scene.path() +
                     ": found the light in every pixel; allowed: at least one pixel without it");
  Film film(loaded.film, film_scale(loaded), options.film_sums);
  Film timed_film = film;
  std::vector<CurvePoint> points;
  CurvePoint sum;
  if (!native_only) sum.timed_cpu_seconds = sum.simulated_seconds = 0.0;
  ProgressBar bar("bench error");
  for (const path_tracer::Work& work : doubling_parts(samples)) {
    const PartialRender native = render_parts(loaded, options, MachineKind::native, {work}).front();
    film.merge(native.film);
    sum.samples = work.first_sample + work.samples;
    sum.native_cpu_seconds += native.cpu_seconds;
    if (!native_only) {
      const PartialRender timed = render_parts(loaded, options, MachineKind::chip, {work}).front();
      timed_film.merge(timed.film);
      *sum.timed_cpu_seconds += timed.cpu_seconds;
      *sum.simulated_seconds += *timed.simulated_seconds;
      if (timed_film.sha256() != film.sha256())
        throw RunError("the image of the chip differs from the native one after " +
                       std::to_string(sum.samples) + " samples");
    }
    sum.error = image_error(film, truth, counts);
    points.push_back(sum);
    bar.show(double(sum.samples) / samples);
  }
  return points;
}

double rmse(const CurvePoint& point) {
  return point.error.mse > 0 ? std::sqrt(point.error.mse) : kNone;
}

/// One column of the curve.
template <class Value>
std::vector<double> column(const std::vector<CurvePoint>& points, Value&& value) {
  std::vector<double> values;
  for (const CurvePoint& point : points) values.push_back(value(point));
  return values;
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

std::string to_csv(const std::vector<CurvePoint>& points) {
  std::ostringstream csv;
  csv.precision(17);
  csv << "samples,rmse,mse,relative_mse,mean_bias_r,mean_bias_g,mean_bias_b,native_cpu_seconds,"
         "timed_cpu_seconds,simulated_seconds,native_mse_seconds,timed_mse_seconds\n";
  const auto field = [&](double value) {
    csv << ',';
    if (value == value) csv << value;  // empty where there is no value
  };
  for (const CurvePoint& point : points) {
    csv << point.samples;
    for (const double value :
         {rmse(point), point.error.mse, point.error.relative_mse, point.error.mean_bias[0],
          point.error.mean_bias[1], point.error.mean_bias[2], point.native_cpu_seconds, timed_seconds(point),
          simulated_seconds(point), cost_of_error(point.error, point.native_cpu_seconds),
          cost_of_error(point.error, timed_seconds(point))})
      field(value);
    csv << '\n';
  }
  return csv.str();
}

void print_table(const std::vector<CurvePoint>& points, bool native_only) {
  std::printf("%8s %10s %10s %24s %10s %10s", "samples", "RMSE", "rel. MSE", "mean bias R, G, B, %",
              "native s", "native C");
  if (!native_only) std::printf(" %10s %10s %12s", "timed s", "timed C", "simulated s");
  std::printf("\n");
  for (const CurvePoint& point : points) {
    const double* const bias = point.error.mean_bias;
    std::printf("%8d %10.6f %10.3e %+8.3f%+8.3f%+8.3f %10.3f %10.3e", point.samples, rmse(point),
                point.error.relative_mse, 100 * bias[0], 100 * bias[1], 100 * bias[2],
                point.native_cpu_seconds, cost_of_error(point.error, point.native_cpu_seconds));
    if (!native_only)
      std::printf(" %10.3f %10.3e %12.3f", timed_seconds(point),
                  cost_of_error(point.error, timed_seconds(point)), simulated_seconds(point));
    std::printf("\n");
  }
}

void print_summary(const std::vector<CurvePoint>& points, bool native_only) {
  const std::vector<double> errors = column(points, rmse);
  std::printf("slope of log RMSE over log samples %.3f, over log native CPU seconds %.3f",
              log_log_slope(column(points, [](const CurvePoint& p) { return double(p.samples); }), errors),
              log_log_slope(column(points, native_seconds), errors));
  if (!native_only)
    std::printf(", over log timed CPU seconds %.3f, over log simulated seconds %.3f",
                log_log_slope(column(points, timed_seconds), errors),
                log_log_slope(column(points, simulated_seconds), errors));
  const CurvePoint& last = points.back();
  std::printf("\nC = MSE x CPU seconds at %d samples: %.3e native", last.samples,
              cost_of_error(last.error, last.native_cpu_seconds));
  if (!native_only) std::printf(", %.3e with timing on", cost_of_error(last.error, timed_seconds(last)));
  std::printf("\n");
}

LogChart make_chart(const std::string& title, const std::vector<CurvePoint>& points, bool native_only) {
  const std::vector<double> errors = column(points, rmse);
  LogChart chart{title, "seconds", "RMSE", {{"native, CPU time", column(points, native_seconds), errors}}};
  if (!native_only) {
    chart.series.push_back({"timing on, CPU time", column(points, timed_seconds), errors});
    chart.series.push_back({"simulated time", column(points, simulated_seconds), errors});
  }
  return chart;
}

void BenchErrorCommand::run() {
  require_outputs();
  options.chip = chip.chip();
  options.level = level.level();
  options.film_sums = FilmSums::means;
  const ExrFilm truth = load_reference();
  const Scene loaded = load(truth);
  std::vector<InputName> inputs = inputs_of(chip, loaded);
  inputs.emplace_back("--reference", reference);
  outputs.require_no_input(inputs);
  const std::vector<CurvePoint> points = measure(loaded, truth);
  print_notes(loaded.notes);
  std::printf("%s, %d x %d, light's pixels left out, reference %s\n", loaded.name.c_str(), loaded.film.width,
              loaded.film.height, reference.c_str());
  print_table(points, native_only);
  print_summary(points, native_only);
  outputs.write("--csv", [&] { return to_csv(points); });
  const std::string& plot = outputs.path("--plot");
  if (plot.empty()) return;
  if (can_draw_charts())
    write_chart(plot, make_chart("Error against time: " + loaded.name, points, native_only));
  else
    print_note("--plot " + plot + " was left out: gnuplot is not installed");
}

}  // namespace

void add_bench_error_command(CLI::App& bench) {
  CLI::App& command =
      *bench.add_subcommand("error",
                            "Error against samples, CPU time and simulated time, natively and with "
                            "timing on");
  const auto state = std::make_shared<BenchErrorCommand>();
  state->scene.add_to(command);
  command
      .add_option("--reference", state->reference, "File of `csx600 bench reference`; sets the film's size")
      ->type_name("FILE")
      ->required();
  in_range(command.add_option("--samples", state->samples, "Largest number of paths a pixel, a power of two"),
           1, 1 << 20)
      ->capture_default_str();
  command.add_flag("--native", state->native_only, "Leave out the runs with timing on");
  state->outputs.add_to(command, "--csv", "Write the curve as CSV");
  state->outputs.add_to(command, "--plot", "Draw RMSE over seconds, .png or .svg (needs gnuplot)");
  state->options.program = path_tracer::default_program();
  state->firmware.add_to(command, state->options.program, {path_tracer::OptionGroup::sampling});
  state->chip.add_to(command, "csx600");
  state->level.add_to(command);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
