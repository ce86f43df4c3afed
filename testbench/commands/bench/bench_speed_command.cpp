#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): POSIX's has mkdtemp

#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/paper/paper.hpp"
#include "testbench/run/render.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/interrupt.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/run_times.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using cn::Level;
using path_tracer::Program;

constexpr int kPes[] = {16, 32, 64, 96, 192, 384, 768, 1024};
/// Waves of a whole run fill a disk; this much of the image shows what tracing costs.
constexpr FilmSize kTracedFilm{96, 96};

/// One kind of run and what its repetitions gave.
struct Variant {
  std::string group;  ///< what it is compared with
  std::string name;
  RenderOptions options;
  FilmSize film;
  bool native = false;
  bool traced = false;

  RunTimes times;
  std::uint64_t segments = 0;
  double simulated_seconds = 0;  ///< 0 for a native run
  std::string image_sha256;

  double segments_per_second() const { return double(segments) / times.median(); }
};

/// The film's hash and what simulated time it took must be the same each time.
void add_result(Variant& variant, const Json& result) {
  const bool first = variant.times.cpu_seconds.empty();
  const auto segments = result["segments"].get<std::uint64_t>();
  const auto simulated_seconds = result["simulated_seconds"].get<double>();
  const auto image_sha256 = result["image_sha256"].get<std::string>();
  if (!first && (segments != variant.segments || simulated_seconds != variant.simulated_seconds ||
                 image_sha256 != variant.image_sha256))
    throw RunError("bench speed: '" + variant.group + ", " + variant.name +
                   "' gave another image or time when it was repeated");
  variant.segments = segments;
  variant.simulated_seconds = simulated_seconds;
  variant.image_sha256 = image_sha256;
  variant.times.cpu_seconds.push_back(result["cpu_seconds"].get<double>());
}

struct BenchSpeedCommand {
  SceneArgument scene{"scenes/cornell_box"};
  ChipOptions chip;
  LevelOption level;
  int samples = 4;
  int repetitions = 5;
  OutputFiles outputs;

  void run();

 private:
  std::vector<Variant> make_variants(const Scene& loaded) const;
  void measure(const Scene& loaded, std::vector<Variant>& variants) const;
  Json to_json(const std::vector<Variant>& variants) const;
};

/// Removed with all that is in it at the end of the scope.
class TemporaryDirectory {
 public:
  TemporaryDirectory() {
    std::string name = (std::filesystem::temp_directory_path() / "csx600_bench_XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw RunError("cannot make a temporary directory like " + name);
    path_ = name;
  }
  ~TemporaryDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryDirectory(const TemporaryDirectory&) = delete;
  TemporaryDirectory& operator=(const TemporaryDirectory&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

std::string run_variant(const Scene& scene, const Variant& variant) {
  const InterruptGuard interrupt;
  const auto progress = [&](double) { return !interrupt.requested(); };
  Scene sized = scene;
  sized.film = variant.film;
  RenderOptions options = variant.options;
  std::optional<TemporaryDirectory> waves;
  if (variant.traced) {
    waves.emplace();
    options.observation.waves = WaveOptions{waves->path() / "waves.vcd", {}};
  }
  const RenderResult result =
      variant.native ? render_natively(sized, options, progress) : render_on_chip(sized, options, progress);
  if (result.is_partial) throw RunError("interrupted; nothing was written");
  require_observed(result);
  return Json{{"cpu_seconds", result.cpu_seconds},
              {"segments", result.counts.segments},
              {"simulated_seconds", result.chip ? result.chip->seconds() : 0.0},
              {"image_sha256", result.film.sha256()}}
      .dump();
}

std::vector<Variant> BenchSpeedCommand::make_variants(const Scene& loaded) const {
  RenderOptions base;
  base.chip = chip.chip();
  base.level = level.level();
  base.work.samples = samples;
  base.program.program = Program::full;
  std::vector<Variant> variants;
  const auto add = [&](const std::string& group, const std::string& name, auto&& change) {
    Variant variant;
    variant.group = group;
    variant.name = name;
    variant.options = base;
    variant.film = loaded.film;
    change(variant);
    variants.push_back(std::move(variant));
  };
  for (const Program program : kPaperPrograms) {
    const auto set_program = [program](Variant& variant) { variant.options.program.program = program; };
    add(name_of(program), "timed", set_program);
    add(name_of(program), "native", [&](Variant& variant) {
      set_program(variant);
      variant.native = true;
    });
  }
  for (const bool traced : {false, true})
    add("waves", traced ? "traced" : "untraced", [&](Variant& variant) {
      variant.traced = traced;
      variant.film = kTracedFilm;
    });
  for (const int pes : kPes)
    add("PEs", std::to_string(pes), [&](Variant& variant) { variant.options.chip.chip.pes = pes; });
  for (const Level of_level : cn::usable_levels())
    if (of_level <= base.level)
      add("level", cn::name_of(of_level), [&](Variant& variant) { variant.options.level = of_level; });
  return variants;
}

/// Each run in a process of its own, one at a time, the kinds in turn.
void BenchSpeedCommand::measure(const Scene& loaded, std::vector<Variant>& variants) const {
  std::vector<std::function<std::string()>> runs;
  for (int i = 0; i < repetitions; ++i)
    for (const Variant& variant : variants)
      runs.emplace_back([&loaded, &variant] { return run_variant(loaded, variant); });
  ProgressBar bar("bench speed");
  const std::vector<std::string> results =
      run_in_processes(runs, 1, [&](int finished) { bar.show(finished / double(runs.size())); });
  for (std::size_t i = 0; i < results.size(); ++i)
    add_result(variants[i % variants.size()], Json::parse(results[i]));
}

const Variant& find(const std::vector<Variant>& variants, const std::string& group, const std::string& name) {
  for (const Variant& variant : variants)
    if (variant.group == group && variant.name == name) return variant;
  throw RunError("bench speed: no run '" + group + ", " + name + "'");
}

void print_programs(const std::vector<Variant>& variants) {
  std::printf("  %-10s %12s %12s %14s %16s %14s\n", "program", "timed", "native", "timed/native",
              "simulated/CPU", "times silicon");
  for (const Program program : kPaperPrograms) {
    const Variant& timed = find(variants, name_of(program), "timed");
    const Variant& native = find(variants, name_of(program), "native");
    std::printf("  %-10s %7.2f M/s  %7.2f M/s  %13.2f  %15.1f  %13.1f\n", name_of(program),
                timed.segments_per_second() * 1e-6, native.segments_per_second() * 1e-6,
                ratio(timed.times, native.times), timed.simulated_seconds / timed.times.median(),
                timed.segments_per_second() / silicon_segments_per_second(program));
  }
}

void print_group(const std::vector<Variant>& variants, const std::string& group,
                 const std::string& reference) {
  const Variant& compared = find(variants, group, reference);
  std::printf("\n  %-10s %16s   %s\n", group.c_str(), "segments/s", ("time, " + reference + " = 1").c_str());
  for (const Variant& variant : variants)
    if (variant.group == group)
      std::printf("  %-10s %12.2f M/s   %6.2f\n", variant.name.c_str(), variant.segments_per_second() * 1e-6,
                  ratio(variant.times, compared.times));
}

Json BenchSpeedCommand::to_json(const std::vector<Variant>& variants) const {
  Json result;
  result["format"] = "csx600-bench-speed-1";
  result["scene"] = scene.path();
  result["samples"] = samples;
  result["runs"] = Json::array();
  for (const Variant& variant : variants)
    result["runs"].push_back(
        {{"group", variant.group},
         {"name", variant.name},
         {"segments", variant.segments},
         {"simulated_seconds", variant.native ? Json() : Json(variant.simulated_seconds)},
         {"image_sha256", variant.image_sha256},
         {"cpu_seconds", variant.times.cpu_seconds},
         {"median_cpu_seconds", variant.times.median()}});
  return result;
}

std::string to_csv(const std::vector<Variant>& variants) {
  std::string text = "group,name,segments,simulated_seconds,median_cpu_seconds\n";
  for (const Variant& variant : variants) {
    char line[160];
    std::snprintf(line, sizeof(line), "%s,%s,%llu,%.9g,%.9g\n", variant.group.c_str(), variant.name.c_str(),
                  static_cast<unsigned long long>(variant.segments), variant.simulated_seconds,
                  variant.times.median());
    text += line;
  }
  return text;
}

void BenchSpeedCommand::run() {
  outputs.require_writable();
  const Scene loaded = scene.load();
  outputs.require_no_input(inputs_of(chip, loaded));
  std::vector<Variant> variants = make_variants(loaded);
  measure(loaded, variants);
  std::printf("%s, %d x %d, %d samples a pixel, chip %s; medians of %d runs in turn, CPU time\n\n",
              loaded.name.c_str(), loaded.film.width, loaded.film.height, samples,
              variants.front().options.chip.preset.c_str(), repetitions);
  print_programs(variants);
  print_group(variants, "waves", "untraced");
  print_group(variants, "PEs", "96");
  print_group(variants, "level", cn::name_of(variants.back().options.level));
  print_notes(loaded.notes);
  outputs.write("--json", [&] { return statistics_json(to_json(variants)); });
  outputs.write("--csv", [&] { return to_csv(variants); });
}

}  // namespace

void add_bench_speed_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "speed",
      "Simulator time of renders: with and without timing, traced, by number of PEs, by x86-64 level");
  const auto state = std::make_shared<BenchSpeedCommand>();
  state->scene.add_to(command);
  state->chip.add_to(command, "paper");
  state->level.add_to(command);
  add_samples_option(command, state->samples);
  in_range(command.add_option("--repetitions", state->repetitions, "Runs of each kind"), 1, 1000)
      ->capture_default_str();
  state->outputs.add_to(command, "--json", "Also write every run's time to this file");
  state->outputs.add_to(command, "--csv", "Also write the medians to this file");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
