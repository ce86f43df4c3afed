#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "testbench/benchmark/error_run.hpp"
#include "testbench/benchmark/error_tables.hpp"
#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/film/chart.hpp"
#include "testbench/statistics/statistics_difference.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/message_text.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

/// A scene with what its images are compared with.
struct ReferencedScene {
  std::string reference;  ///< its file
  ExrFilm truth;
  Scene scene;
};

struct BenchErrorCommand {
  SceneArguments scenes;
  std::vector<std::string> references;
  OutputFiles outputs;
  bool native_only = false;
  int samples = 16384;
  int timed_samples = 1024;
  RenderOptions options;
  ChipOptions chip;
  LevelOption level;
  FirmwareLists firmware;

  void run();

 private:
  void require_powers_of_two() const;
  ReferencedScene load(std::size_t index, const std::vector<path_tracer::ProgramConfig>& programs) const;
  std::vector<ReferencedScene> load_all(const std::vector<path_tracer::ProgramConfig>& programs) const;
  RenderOptions options_of(const Scene& scene, const path_tracer::ProgramConfig& program) const;
  std::vector<ErrorCurve> measure(const std::vector<ReferencedScene>& loaded,
                                  const std::vector<path_tracer::ProgramConfig>& programs) const;
  void print(const std::vector<ReferencedScene>& loaded, const std::vector<ErrorCurve>& curves) const;
  void draw(const std::vector<ErrorCurve>& curves) const;
};

void BenchErrorCommand::require_powers_of_two() const {
  const auto require = [](const char* option, int count) {
    if ((count & (count - 1)) != 0)
      throw InputError(std::string(option) + ": found " + std::to_string(count) +
                       ", allowed is a power of two");
  };
  require("--samples", samples);
  require("--timed-samples", timed_samples);
}

/// The file of a scene's reference, unless another is named.
std::string shipped_reference(const std::string& scene) {
  const std::filesystem::path path(scene);
  return ((path.extension() == ".toml" ? path.parent_path() : path) / "reference.exr").string();
}

ExrFilm load_reference(const std::string& file, const std::string& scene,
                       const std::vector<path_tracer::ProgramConfig>& programs) {
  ExrFilm truth = read_exr_film(file);
  const auto seed = truth.attributes.find(kSeedAttribute);
  const auto of_scene = truth.attributes.find("csx600.scene");
  if (seed == truth.attributes.end() || of_scene == truth.attributes.end())
    throw InputError(file + ": found no attribute " + kSeedAttribute +
                     "; allowed: a file of `csx600 bench reference`");
  if (scene_name_of(of_scene->second) != scene_name_of(scene))
    throw InputError(file + ": found a reference of '" + of_scene->second + "', allowed is one of " + scene);
  for (const path_tracer::ProgramConfig& program : programs)
    if (seed->second == std::to_string(program.seed))
      throw InputError("--seed: found " + seed->second + ", the reference's; allowed is any other");
  return truth;
}

ReferencedScene BenchErrorCommand::load(std::size_t index,
                                        const std::vector<path_tracer::ProgramConfig>& programs) const {
  const std::string& path = scenes.paths()[index];
  ReferencedScene loaded;
  loaded.reference = references.empty() ? shipped_reference(path) : references[index];
  loaded.truth = load_reference(loaded.reference, path, programs);
  loaded.scene = scenes.load(path);
  loaded.scene.film = {loaded.truth.width, loaded.truth.height};
  return loaded;
}

std::vector<ReferencedScene> BenchErrorCommand::load_all(
    const std::vector<path_tracer::ProgramConfig>& programs) const {
  if (!references.empty() && references.size() != scenes.paths().size())
    throw InputError("--reference: found " + std::to_string(references.size()) +
                     ", allowed is one for each of " + std::to_string(scenes.paths().size()) +
                     " scenes, or none");
  std::vector<ReferencedScene> loaded;
  for (std::size_t i = 0; i < scenes.paths().size(); ++i) loaded.push_back(load(i, programs));
  std::vector<InputName> inputs = chip.inputs();
  for (const ReferencedScene& each : loaded) {
    const std::vector<InputName> of_scene = inputs_of(chip, each.scene);
    inputs.insert(inputs.end(), of_scene.begin(), of_scene.end());
    inputs.emplace_back("--reference", each.reference);
  }
  outputs.require_no_input(inputs);
  return loaded;
}

RenderOptions BenchErrorCommand::options_of(const Scene& scene,
                                            const path_tracer::ProgramConfig& program) const {
  RenderOptions of = options;
  of.program = program_for(scene, of.chip, program, firmware.given());
  return of;
}

std::vector<ErrorCurve> BenchErrorCommand::measure(
    const std::vector<ReferencedScene>& loaded,
    const std::vector<path_tracer::ProgramConfig>& programs) const {
  const CurveSamples counts{samples, native_only ? 0 : std::min(samples, timed_samples)};
  const double all = double(loaded.size() * programs.size());
  std::vector<ErrorCurve> curves;
  ProgressBar bar("bench error");
  for (const ReferencedScene& each : loaded)
    for (const path_tracer::ProgramConfig& program : programs) {
      const double done = double(curves.size());
      const auto progress = [&](double share) { bar.show((done + share) / all); };
      curves.push_back(
          {each.scene.name, program,
           measure_error(each.scene, each.truth, options_of(each.scene, program), counts, progress)});
    }
  return curves;
}

void BenchErrorCommand::print(const std::vector<ReferencedScene>& loaded,
                              const std::vector<ErrorCurve>& curves) const {
  for (const ReferencedScene& each : loaded) print_notes(each.scene.notes);
  const std::size_t curves_of_scene = curves.size() / loaded.size();
  for (std::size_t i = 0; i < curves.size(); ++i) {
    const ReferencedScene& of = loaded[i / curves_of_scene];
    std::printf("%s%s, %d x %d, light's pixels left out, reference %s\n%s", i == 0 ? "" : "\n",
                curve_label(curves, i).c_str(), of.scene.film.width, of.scene.film.height,
                printable(of.reference).c_str(), curve_table(curves[i]).c_str());
  }
  const std::string comparison = comparison_table(curves);
  if (!comparison.empty()) std::printf("\n%s", comparison.c_str());
}

void BenchErrorCommand::draw(const std::vector<ErrorCurve>& curves) const {
  const std::string& plot = outputs.path("--plot");
  if (plot.empty()) return;
  if (can_draw_charts())
    write_chart(plot, error_chart(curves));
  else
    print_note("--plot " + plot + " was left out: gnuplot is not installed");
}

void BenchErrorCommand::run() {
  require_powers_of_two();
  outputs.require_writable();
  options.chip = chip.chip();
  options.level = level.level();
  options.film_sums = FilmSums::means;
  const std::vector<path_tracer::ProgramConfig> programs = firmware.product(options.program);
  const std::vector<ReferencedScene> loaded = load_all(programs);
  const std::vector<ErrorCurve> curves = measure(loaded, programs);
  print(loaded, curves);
  outputs.write("--csv", [&] { return curves_csv(curves); });
  draw(curves);
}

}  // namespace

void add_bench_error_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "error",
      "Error against samples, CPU time, simulated time and energy, natively and with timing on; for several "
      "scenes, and for every combination of the firmware's options, which may be lists");
  const auto state = std::make_shared<BenchErrorCommand>();
  state->scenes.add_to(command);
  command
      .add_option("--reference", state->references,
                  "File of `csx600 bench reference`, one for each scene in their order; sets the film's size")
      ->type_name("FILE")
      ->allow_extra_args(false)
      ->default_str("SCENE/reference.exr");
  in_range(command.add_option("--samples", state->samples, "Largest number of paths a pixel, a power of two"),
           1, 1 << 20)
      ->capture_default_str();
  in_range(command.add_option("--timed-samples", state->timed_samples,
                              "The same with timing on, if that is fewer"),
           1, 1 << 20)
      ->capture_default_str();
  command.add_flag("--native", state->native_only, "Leave out the runs with timing on");
  state->outputs.add_to(command, "--csv", "Write the curves as CSV");
  state->outputs.add_to(command, "--plot", "Draw RMSE over seconds, .png or .svg (needs gnuplot)");
  state->options.program = path_tracer::default_program();
  state->firmware.add_to(command, state->options.program, options_of_curves());
  state->chip.add_to(command, "csx600");
  state->level.add_to(command);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
