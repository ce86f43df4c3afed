#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/plug_in/firmware_path.hpp"
#include "testbench/run/timing_name.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/sensitivity/run_file.hpp"
#include "testbench/sensitivity/sensitivity_table.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// Of a scene's own film: enough rays for the time of a longer run to show, few enough for many runs.
constexpr int kMostPixels = 128 * 128;
constexpr const char* kSamples = "4";

struct SensitivityCommand {
  std::string input;
  std::string chip;
  std::string size;
  std::string samples;
  std::vector<std::string> settings;
  std::vector<std::string> only;
  int percent = 10;
  int shown = 20;
  int jobs = 1;
  SensitivityOrder order = SensitivityOrder::time;
  TimingOption timing;
  const CLI::Option* timing_option = nullptr;
  ReachOption reach;
  OutputFiles outputs;

  void run() const;

 private:
  bool is_run() const { return std::filesystem::path(input).extension() == ".json"; }
  bool is_firmware() const {
    const std::vector<std::string> installed = installed_firmwares();
    return std::filesystem::path(input).extension() == ".so" ||
           std::find(installed.begin(), installed.end(), input) != installed.end();
  }
  std::string default_size() const;
  SweepFile base(const Json* run) const;
  std::vector<Setting> overrides() const;
  void print(const Sensitivity& sensitivity, const Json* run) const;
  void write(const Sensitivity& sensitivity) const;
};

/// The scene's film, scaled to so many pixels if it has more.
std::string SensitivityCommand::default_size() const {
  const FilmSize film = load_scene(input, reach.is_outside_allowed()).film;
  const double scale = std::min(1.0, std::sqrt(kMostPixels / (double(film.width) * double(film.height))));
  const auto side = [&](int pixels) { return std::to_string(std::max(1, int(std::lround(pixels * scale)))); };
  return side(film.width) + "x" + side(film.height);
}

/// What the input itself says of the run.
SweepFile SensitivityCommand::base(const Json* run) const {
  SweepFile file;
  file.path = input;
  if (run != nullptr) {
    file.base = settings_of_run(*run, input);
  } else if (is_firmware()) {
    file.base = {{kFirmwareKey, input, "the firmware"}};
  } else {
    file.base = {{"scene", input, "the scene"},
                 {"samples", kSamples, "--samples"},
                 {"size", size.empty() ? default_size() : size, "--size"}};
  }
  return file;
}

std::vector<Setting> SensitivityCommand::overrides() const {
  std::vector<Setting> all;
  if (!chip.empty()) all.push_back({"chip", chip, "--chip"});
  if (!size.empty()) all.push_back({"size", size, "--size"});
  if (!samples.empty()) all.push_back({"samples", samples, "--samples"});
  if (timing_option->count() > 0) all.push_back({"timing", timing_name(timing.style()), "--timing"});
  const std::vector<Setting> given = settings_of(settings);
  all.insert(all.end(), given.begin(), given.end());
  return all;
}

void SensitivityCommand::print(const Sensitivity& sensitivity, const Json* run) const {
  const Json& statistics = *sensitivity.statistics;
  if (run != nullptr && run->contains("simulated_cycles") &&
      (*run)["simulated_cycles"] != statistics["simulated_cycles"] && settings.empty() && size.empty() &&
      samples.empty() && chip.empty())
    print_note(input + ": says " + value_of((*run)["simulated_cycles"]) + " cycles, this run takes " +
               value_of(statistics["simulated_cycles"]) +
               ": another build wrote it, or it took its paths from a target or a budget");
  if (statistics.contains("width"))
    std::printf("%s, %s x %s, %s samples a pixel, ", value_of(statistics["scene"]).c_str(),
                value_of(statistics["width"]).c_str(), value_of(statistics["height"]).c_str(),
                value_of(statistics["firmware"]["samples"]).c_str());
  else
    std::printf("%s, ", value_of(statistics["firmware"]["name"]).c_str());
  std::printf(
      "chip %s: %.0f cycles, %.6g s, %.4g J\n%zu runs with one parameter changed, %d of them by "
      "replaying one recording\n\n",
      value_of(statistics["chip_preset"]).c_str(), sensitivity.base.cycles, sensitivity.base.seconds,
      sensitivity.base.joules, sensitivity.runs.size(), sensitivity.replayed);
  std::fputs(sensitivity_text(sensitivity, order, shown).c_str(), stdout);
}

void SensitivityCommand::write(const Sensitivity& sensitivity) const {
  outputs.write("--csv", [&] { return sensitivity_csv(sensitivity, order); });
  outputs.write("--stats", [&] {
    Json statistics = *sensitivity.statistics;
    statistics["sensitivity"] = sensitivity_json(sensitivity, order);
    return statistics_json(statistics);
  });
}

void SensitivityCommand::run() const {
  outputs.require_writable();
  outputs.require_no_input({{"the input", input}, {"--chip", chip}});
  Json statistics;
  if (is_run()) statistics = read_statistics(input);
  const Json* const of_run = is_run() ? &statistics : nullptr;
  const Sweep sweep(base(of_run), overrides(), reach.is_outside_allowed());
  const SweepPoint& point = sweep.points().front();
  Variations variations = variations_of(chip_of(point), percent / 100.0, only);
  if (variations.list.empty() && !variations.left_out.empty())
    throw InputError("--only: found no parameter that can change: " + variations.left_out.front().key + ": " +
                     variations.left_out.front().reason);
  if (variations.list.empty())
    throw InputError(
        "--only: found no parameter of the chip that begins so; allowed: the "
        "beginnings of keys that 'csx600 params' lists");
  ProgressBar bar("sensitivity");
  const Sensitivity sensitivity = measure_sensitivity(point, std::move(variations), percent / 100.0, jobs,
                                                      [&](double share) { bar.show(share); });
  write(sensitivity);
  for (const auto& [path, notes] : sweep.notes()) print_notes(notes);
  print(sensitivity, of_run);
}

}  // namespace

void add_sensitivity_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "sensitivity", "Show what each parameter of the chip does to a run's time and energy");
  const auto state = std::make_shared<SensitivityCommand>();
  command
      .add_option(
          "input", state->input,
          "Scene, firmware from a shared library, or the statistics (.json) of a run that is made again")
      ->type_name("SCENE|LIBRARY|RUN")
      ->required();
  state->reach.add_to(command);
  command.add_option("--by", state->percent, "How far each number is changed, less and more")
      ->check(CLI::Range(1, 99))
      ->type_name("PERCENT")
      ->capture_default_str();
  command.add_option("--only", state->only, "Parameters whose key begins so; may be repeated")
      ->type_name("KEY")
      ->allow_extra_args(false);
  one_of(command.add_option("--order", state->order, "What decides which parameters come first")
             ->default_str("time"),
         std::map<std::string, SensitivityOrder>{{"time", SensitivityOrder::time},
                                                 {"energy", SensitivityOrder::energy}});
  in_range(command.add_option("--show", state->shown, "Parameters that are printed")->capture_default_str(),
           1, 1000);
  command.add_option("--size", state->size, "Film in pixels")
      ->type_name("WIDTHxHEIGHT")
      ->default_str("the scene's, at most 128 x 128 pixels");
  command.add_option("--samples", state->samples, "Paths a pixel")
      ->type_name("NUMBER")
      ->default_str(kSamples);
  command.add_option("--chip", state->chip, "Preset or .toml file (see `csx600 params`)")
      ->check(error_of_no_file, "")
      ->type_name("PRESET|FILE")
      ->default_str("csx600");
  command
      .add_option("--set", state->settings,
                  "One value of the run, key=value: any key of a sweep; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  state->timing.add_to(command);
  state->timing_option = command.get_option("--timing");
  add_jobs_option(command, state->jobs);
  state->outputs.add_to(command, "--csv", "Write every run as CSV");
  state->outputs.add_to(
      command, "--stats,--json",
      "Write the run's statistics with the section `sensitivity`, which `csx600 report` shows");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
