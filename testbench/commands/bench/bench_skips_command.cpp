#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/mono_image/scene_features.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/validation/skips.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

struct BenchSkipsCommand {
  SceneArgument scene{"scenes/cornell_box"};
  SizeOption size;
  RenderOptions options;
  ChipOptions chip;
  LevelOption level;
  FirmwareOptions firmware;
  int jobs = 1;
  OutputFiles outputs;

  void run();

 private:
  std::vector<Json> measure(const Scene& loaded) const;
};

std::string measure_run(const Scene& scene, const RenderOptions& options) {
  const RenderResult result = render_on_chip(scene, options);
  const model::PioStatistics& pio = result.chip->pio;
  Json json{{"cycles", result.chip->firmware_cycles},
            {"pio_bytes", pio.bytes_to_poly + pio.bytes_to_mono},
            {"sram_bytes", result.chip->poly_sram.peak_bytes},
            {"image_sha256", result.film.sha256()}};
  for (const Skip& skip : skip_table()) {
    const SkipCount count = skip.count == nullptr ? SkipCount{} : skip.count(result);
    json["counts"].push_back({count.skipped, count.all});
  }
  return json.dump();
}

/// The run as it is, then one for each skip that is switched off.
std::vector<Json> BenchSkipsCommand::measure(const Scene& loaded) const {
  std::vector<std::function<std::string()>> runs = {[&] { return measure_run(loaded, options); }};
  for (const Skip& skip : skip_table()) {
    RenderOptions without = options;
    skip.switch_off(without.program);
    runs.emplace_back([&loaded, without] { return measure_run(loaded, without); });
  }
  ProgressBar bar("bench skips");
  std::vector<Json> results;
  for (const std::string& result :
       run_in_processes(runs, jobs, [&](int finished) { bar.show(finished / double(runs.size())); }))
    results.push_back(Json::parse(result));
  return results;
}

const char* image_text(const Skip& skip, const Json& with, const Json& without) {
  if (with["image_sha256"] == without["image_sha256"]) return "same bits";
  return skip.is_exact ? "DIFFERS" : "to rounding";
}

void print_row(const std::string& name, const std::string& off_by, const std::string& fired,
               const Json& run) {
  std::printf("%-38s %-27s %18s %12llu %8.2f %6d", name.c_str(), off_by.c_str(), fired.c_str(),
              run["cycles"].get<unsigned long long>(), run["pio_bytes"].get<double>() / 1e6,
              run["sram_bytes"].get<int>());
}

void print_table(const std::vector<Json>& results) {
  const Json& with = results.front();
  std::printf("%-38s %-27s %18s %12s %8s %6s %7s  %s\n", "what is skipped", "switched off by", "fired",
              "cycles", "PIO MB", "SRAM", "saves", "image");
  print_row("all of these", "", "", with);
  std::printf("\n");
  for (std::size_t i = 0; i < skip_table().size(); ++i) {
    const Skip& skip = skip_table()[i];
    const Json& without = results[i + 1];
    const Json& count = with["counts"][i];
    const std::string fired = skip.count == nullptr ? "-" : count[0].dump() + " of " + count[1].dump();
    print_row(skip.name, skip.switched_off_by, fired, without);
    std::printf(" %6.1f%%  %s\n", 100 * (1 - with["cycles"].get<double>() / without["cycles"].get<double>()),
                image_text(skip, with, without));
  }
}

Json to_json(const std::string& scene, const std::vector<Json>& results) {
  Json json{{"format", "csx600-bench-skips-1"}, {"scene", scene}, {"with_all", results.front()}};
  for (std::size_t i = 0; i < skip_table().size(); ++i) {
    Json without = results[i + 1];
    without.erase("counts");
    without["skip"] = skip_table()[i].name;
    without["switched_off_by"] = skip_table()[i].switched_off_by;
    json["without"].push_back(without);
  }
  return json;
}

void BenchSkipsCommand::run() {
  outputs.require_writable();
  size.require_valid();
  options.chip = chip.chip();
  options.level = level.level();
  const Scene loaded = size.resized(scene.load());
  outputs.require_no_input(inputs_of(chip, loaded));
  // The tree must fit beside the records of a program for anything.
  options.program.built_for = path_tracer::kBuiltForAnything;
  options.program = built_for(loaded, options.program);
  choose_tree(TriangleCount(loaded), options.chip, firmware.given(), options.program);
  options.program.built_for = path_tracer::kBuiltForScene;
  const std::vector<Json> results = measure(loaded);
  print_notes(loaded.notes);
  std::printf("%s at %d x %d, %d samples a pixel; chip %s; %s\n\n", loaded.name.c_str(), loaded.film.width,
              loaded.film.height, options.work.samples, options.chip.preset.c_str(),
              name_of(options.program.traversal));
  print_table(results);
  outputs.write("--json", [&] { return json_text(to_json(loaded.name, results), 2) + "\n"; });
}

}  // namespace

void add_bench_skips_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "skips", "What it would cost to do the work that the firmware leaves out, kind by kind");
  const auto state = std::make_shared<BenchSkipsCommand>();
  state->options.program = path_tracer::default_program();
  state->options.work.samples = 4;
  state->scene.add_to(command);
  state->size.add_to(command);
  state->chip.add_to(command, "csx600");
  state->level.add_to(command);
  add_samples_option(command, state->options.work.samples);
  add_jobs_option(command, state->jobs);
  state->outputs.add_to(command, "--json", "Also write the table to this file");
  using path_tracer::OptionGroup;
  state->firmware.add_to(command, state->options.program,
                         {OptionGroup::bins, OptionGroup::sampling, OptionGroup::tree});
  command.callback([state] { state->run(); });
}

}  // namespace testbench
