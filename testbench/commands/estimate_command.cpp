#include <cstdio>
#include <cstdlib>
#include <memory>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/estimate/estimate.hpp"
#include "testbench/run/program_choice.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/system/progress_bar.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// What people ask of a long job; the JSON file has every counter.
struct ShownFigure {
  const char* key;
  const char* name;
};
constexpr ShownFigure kShown[] = {{"simulated_seconds", "simulated time, s"},
                                  {"simulated_cycles", "simulated cycles"},
                                  {"chip.energy.joules", "energy, J"},
                                  {"segments", "path segments"},
                                  {"rays", "rays"},
                                  {"chip.pio.busy_cycles", "PIO busy, cycles"},
                                  {"chip.ddr.bytes_read", "DDR read, bytes"},
                                  {"chip.ddr.bytes_written", "DDR written, bytes"}};

/// "0.5%" or "0.5": a share.
double share_from(const std::string& text) {
  char* end = nullptr;
  const double percent = std::strtod(text.c_str(), &end);
  const std::string rest = end;
  if (end == text.c_str() || (!rest.empty() && rest != "%") || !(percent > 0 && percent <= 100))
    throw InputError("--within: found '" + text + "', allowed is a percentage above 0, at most 100");
  return percent / 100;
}

struct EstimateCommand {
  SceneArgument scene;
  SizeOption size;
  RenderOptions options;
  ChipOptions chip;
  TimingOption timing;
  LevelOption level;
  FirmwareOptions firmware;
  std::string within = "0.5%";
  int jobs = 1;
  bool check = false;
  OutputFiles outputs;

  void run();

 private:
  RenderRequest request(const Scene& loaded) const;
  Estimate full_run(const Scene& loaded, const RenderRequest& request) const;
  void print(const Scene& loaded, const Estimate& estimate, const Estimate* full) const;
  std::string json(const Estimate& estimate, const Estimate* full) const;
};

RenderRequest EstimateCommand::request(const Scene& loaded) const {
  RenderRequest request{scene.path(), options, false};
  request.options.chip = chip.chip();
  request.options.timing = timing.style();
  request.options.level = level.level();
  request.options.film_sums = FilmSums::means;
  request.traversal_reason =
      choose_program(loaded, request.options.chip, firmware.given(), request.options.program);
  return request;
}

/// In a process of its own, as every run on the chip.
Estimate EstimateCommand::full_run(const Scene& loaded, const RenderRequest& request) const {
  const auto run = [&] {
    Json counters = Json::object();
    for (const EstimatedCounter& counter : render_in_full(loaded, request).counters)
      counters[counter.key] = counter.value;
    return json_text(counters);
  };
  Estimate full;
  const Json counters = Json::parse(run_in_processes({run}, 1)[0]);
  for (const auto& [key, value] : counters.items()) full.counters.push_back({key, value, 0});
  return full;
}

void EstimateCommand::print(const Scene& loaded, const Estimate& estimate, const Estimate* full) const {
  std::printf("%s, %d x %d, %d samples a pixel, chip %s\n", loaded.name.c_str(), loaded.film.width,
              loaded.film.height, estimate.samples, chip.chip().preset.c_str());
  if (estimate.batches == 0)
    std::printf("run in full: parts of so short a job would not tell it within %s\n\n", within.c_str());
  else
    std::printf("from %d batches of %d samples and halves of some: %d samples, %.2f %% of the job\n\n",
                estimate.batches, estimate.samples_of_a_batch, estimate.samples_rendered,
                100.0 * estimate.samples_rendered / estimate.samples);
  std::printf("%-22s %14s %14s", "", "estimate", "+- (95 %)");
  if (full != nullptr) std::printf(" %14s %9s", "full run", "off by");
  std::printf("\n");
  for (const ShownFigure& shown : kShown) {
    const EstimatedCounter& counter = estimate.counter(shown.key);
    std::printf("%-22s %14.7g %14.3g", shown.name, counter.value, counter.half_width);
    if (full != nullptr) {
      const double value = full->counter(shown.key).value;
      std::printf(" %14.7g %+8.3f%%%s", value, value > 0 ? 100 * (counter.value / value - 1) : 0.0,
                  std::abs(counter.value - value) <= counter.half_width ? "" : "  outside");
    }
    std::printf("\n");
  }
}

std::string EstimateCommand::json(const Estimate& estimate, const Estimate* full) const {
  Json json{{"format", "csx600-estimate-1"}, {"scene", scene.path()},
            {"samples", estimate.samples},   {"samples_rendered", estimate.samples_rendered},
            {"batches", estimate.batches},   {"confidence", 0.95}};
  for (const EstimatedCounter& counter : estimate.counters) {
    Json& figure = json["counters"][counter.key];
    figure = {{"value", counter.value}, {"half_width", counter.half_width}};
    if (full != nullptr) figure["full_run"] = full->counter(counter.key).value;
  }
  return json_text(json, 2) + "\n";
}

void EstimateCommand::run() {
  outputs.require_writable();
  size.require_valid();
  const double share = share_from(within);
  const Scene loaded = size.resized(scene.load());
  outputs.require_no_input(inputs_of(chip, loaded));
  const RenderRequest of = request(loaded);
  Estimate estimate;
  {
    ProgressBar bar("estimate");
    const auto show = [&](int parts) { bar.show(double(parts) / double(parts + 1)); };
    estimate = estimate_render(loaded, of, {share, jobs}, show);
  }
  std::optional<Estimate> full;
  if (check) full = estimate.batches == 0 ? estimate : full_run(loaded, of);
  outputs.write("--json", [&] { return json(estimate, full ? &*full : nullptr); });
  print_notes(loaded.notes);
  print(loaded, estimate, full ? &*full : nullptr);
}

}  // namespace

void add_estimate_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "estimate", "Tell time, energy and counters of a long render from short parts of it");
  const auto state = std::make_shared<EstimateCommand>();
  state->options.program = path_tracer::default_program();
  state->options.work.samples = 1000;
  state->scene.add_to(command);
  add_samples_option(command, state->options.work.samples);
  command
      .add_option("--within", state->within,
                  "Stop when the simulated time's interval of 95 % is this narrow, each way")
      ->type_name("PERCENT")
      ->capture_default_str();
  state->size.add_to(command);
  state->chip.add_to(command, "csx600");
  state->timing.add_to(command);
  state->level.add_to(command);
  add_jobs_option(command, state->jobs);
  command.add_flag("--check", state->check, "Run the whole render, too, and compare");
  using path_tracer::OptionGroup;
  state->firmware.add_to(command, state->options.program,
                         {OptionGroup::bins, OptionGroup::sampling, OptionGroup::tree});
  state->outputs.add_to(command, "--json", "Write every counter with its interval");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
