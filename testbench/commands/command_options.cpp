#include "testbench/commands/command_options.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <thread>

#include "model/config/chip_file.hpp"
#include "model/config/chip_parameters.hpp"
#include "model/config/chip_presets.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/film/film_size.hpp"
#include "testbench/run/run_settings.hpp"
#include "testbench/run/timing_name.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

constexpr const char* kWhatASceneIs =
    "Directory with a scene.toml, a .toml file, or a mesh (.obj, .ply, .gltf, .glb)";

}  // namespace

void SetOptions::add_to(CLI::App& command) {
  command.add_option("--set", settings_, "One parameter of the chip, key=value; may be repeated")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
}

void ChipOptions::add_to(CLI::App& command, const std::string& default_chip) {
  chip_ = default_chip;
  command.add_option("--chip", chip_, "Preset or .toml file (see `csx600 params`)")
      ->type_name("{" + CLI::detail::join(model::preset_names(), ", ") + "}|FILE")
      ->capture_default_str();
  settings_.add_to(command);
}

std::vector<InputName> ChipOptions::inputs() const {
  if (std::filesystem::path(chip_).extension() != ".toml") return {};
  return {{"--chip", chip_}};
}

std::vector<InputName> inputs_of(const ChipOptions& chip, const Scene& scene) {
  std::vector<InputName> inputs = chip.inputs();
  for (const std::filesystem::path& file : scene.files)
    inputs.emplace_back("scene " + scene.name, file.string());
  return inputs;
}

Setting setting_of(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos) throw InputError("--set: found '" + text + "', allowed is key=value");
  return {text.substr(0, equals), text.substr(equals + 1), "--set"};
}

std::vector<Setting> settings_of(const std::vector<std::string>& texts) {
  std::vector<Setting> settings;
  for (const std::string& text : texts) settings.push_back(setting_of(text));
  return settings;
}

model::ChipConfig SetOptions::chip(const std::string& name) const {
  try {
    model::ChipConfig config = load_chip(name);
    for (const std::string& text : settings_) {
      const Setting setting = setting_of(text);
      model::set_parameter(config, setting.key, setting.value, setting.origin);
    }
    model::validate(config);
    return config;
  } catch (const model::ConfigError& error) {
    throw InputError(error.what());
  }
}

void TimingOption::add_to(CLI::App& command) {
  std::map<std::string, model::TimingStyle> styles;
  for (std::size_t i = 0; i < kTimingNames.size(); ++i) styles[kTimingNames[i]] = model::TimingStyle(i);
  one_of(command.add_option(
             "--timing", style_,
             "lt: loosely timed, fast; at: approximately timed, packet by packet in SystemC time"),
         styles)
      ->default_str(timing_name(style_));
}

void LevelOption::add_to(CLI::App& command) {
  std::map<std::string, Choice> choices = {{"auto", kWidest}};
  for (const cn::Level level : {cn::Level::x86_64_v2, cn::Level::x86_64_v3, cn::Level::x86_64_v4})
    choices[cn::name_of(level)] = static_cast<Choice>(level);
  one_of(command.add_option("--level", choice_,
                            "x86-64 level of the kernels; auto: the widest that this machine executes"),
         choices)
      ->default_str("auto");
}

cn::Level LevelOption::level() const {
  if (choice_ == kWidest) return cn::widest_level();
  std::string allowed = "auto";
  for (const cn::Level level : cn::usable_levels()) {
    if (static_cast<Choice>(level) == choice_) return level;
    allowed += " or " + cn::name_of(level);
  }
  throw InputError("--level: found " + cn::name_of(static_cast<cn::Level>(choice_)) +
                   ", this build on this machine has " + allowed);
}

void TimeLimitOption::add_to(CLI::App& command) {
  in_range(
      command.add_option("--time-limit", seconds_,
                         "Seconds after which a run that has not ended fails, for firmware that never does"),
      1, 1000000)
      ->default_str("none");
}

void ReachOption::add_to(CLI::App& command) {
  command.add_flag("--allow-outside", is_outside_allowed_,
                   "Let a scene read files that do not lie below its own folder");
}

void SceneArgument::add_to(CLI::App& command) {
  CLI::Option* const argument = command.add_option("scene", path_, kWhatASceneIs)->type_name("SCENE");
  if (path_.empty())
    argument->required();
  else
    argument->capture_default_str();
  reach_.add_to(command);
}

Scene SceneArgument::load_other(const std::string& path) const {
  return load_scene(path, reach_.is_outside_allowed());
}

void SceneArguments::add_to(CLI::App& command) {
  command.add_option("scene", paths_, kWhatASceneIs)->type_name("SCENE")->required();
  reach_.add_to(command);
}

Scene SceneArguments::load(const std::string& path) const {
  return load_scene(path, reach_.is_outside_allowed());
}

void SizeOption::add_to(CLI::App& command) {
  command.add_option("--size", size_, "Film in pixels")
      ->type_name("WIDTHxHEIGHT")
      ->default_str("the scene's");
}

void SizeOption::require_valid() const {
  if (!size_.empty() && !parse_film_size(size_))
    throw InputError("--size: found '" + size_ + "', allowed is " + allowed_film_size());
}

Scene SizeOption::resized(Scene scene) const {
  require_valid();
  if (!size_.empty()) scene.film = *parse_film_size(size_);
  return scene;
}

void add_samples_option(CLI::App& command, int& samples) {
  in_range(command.add_option("--samples", samples, "Paths a pixel"), 1, 1 << 20)->capture_default_str();
}

void add_jobs_option(CLI::App& command, int& jobs) {
  jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  in_range(command.add_option("--jobs", jobs, "Runs at a time, each in a process of its own"), 1, 1024)
      ->capture_default_str();
}

void add_check_hazards_flag(CLI::App& command, bool& check_hazards) {
  command.add_flag(
      "--check-hazards", check_hazards,
      "Stop when the firmware uses what a transfer may still read or write (with kernels built for that)");
}

void print_notes(const Notes& notes) {
  for (const std::string& line : notes.lines()) print_note(line);
}

}  // namespace testbench
