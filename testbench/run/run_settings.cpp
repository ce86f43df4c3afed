#include "testbench/run/run_settings.hpp"

#include <algorithm>
#include <charconv>

#include "firmware/path_tracer/program/program_options.hpp"
#include "model/config/chip_file.hpp"
#include "testbench/files/input_file.hpp"
#include "testbench/film/film_size.hpp"
#include "testbench/run/timing_name.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/nesting.hpp"

namespace testbench {
namespace {

using model::Effect;
using path_tracer::ProgramOption;

constexpr int kMostSamples = 1 << 20;

constexpr std::string_view kFirmware = "firmware.";

std::optional<int> integer_from(const std::string& text, int low, int high) {
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  if (number < low || number > high) return std::nullopt;
  return number;
}

template <std::string RunSettings::*member>
RunParameter name(const std::string& key, const std::string& allowed) {
  return {key, allowed, Effect::stream,
          [](RunSettings& run, const std::string& value) {
            if (value.empty()) return false;
            run.*member = value;
            return true;
          },
          [](const RunSettings& run) { return run.*member; }};
}

RunParameter size() {
  return {"size", allowed_film_size(), Effect::stream,
          [](RunSettings& run, const std::string& value) {
            if (!parse_film_size(value)) return false;
            run.size = value;
            return true;
          },
          [](const RunSettings& run) { return run.size; }};
}

RunParameter samples() {
  return {"samples", "an integer from 1 to " + std::to_string(kMostSamples), Effect::stream,
          [](RunSettings& run, const std::string& value) {
            const std::optional<int> number = integer_from(value, 1, kMostSamples);
            if (number) run.options.work.samples = *number;
            return number.has_value();
          },
          [](const RunSettings& run) { return std::to_string(run.options.work.samples); }};
}

RunParameter timing() {
  return {"timing", "one of lt, at", Effect::timing,
          [](RunSettings& run, const std::string& value) {
            const auto found = std::find(kTimingNames.begin(), kTimingNames.end(), value);
            if (found == kTimingNames.end()) return false;
            run.options.timing = model::TimingStyle(found - kTimingNames.begin());
            return true;
          },
          [](const RunSettings& run) { return std::string(timing_name(run.options.timing)); }};
}

RunParameter firmware_parameter(const ProgramOption& option) {
  return {std::string(kFirmware) + option.name, allowed_text(option), Effect::stream,
          [&option](RunSettings& run, const std::string& text) {
            const std::optional<path_tracer::OptionValue> value = path_tracer::value_of(option, text);
            if (value) option.write(run.options.program, *value);
            return value.has_value();
          },
          [&option](const RunSettings& run) {
            return path_tracer::value_text(option.read(run.options.program));
          }};
}

std::vector<RunParameter> declare() {
  std::vector<RunParameter> table = {
      name<&RunSettings::scene>("scene", "a directory with a scene.toml, or a .toml file"),
      name<&RunSettings::chip>("chip", "a preset of `csx600 params --presets` or a .toml file"), size(),
      samples(), timing()};
  for (const ProgramOption& option : path_tracer::program_options())
    table.push_back(firmware_parameter(option));
  return table;
}

void refuse(const Setting& setting, const std::string& allowed) {
  throw InputError(setting.origin + ": " + setting.key + ": found '" + setting.value +
                   "'; allowed: " + allowed);
}

/// Writes a parameter of the chip. Throws InputError with what the chip's table says of it.
void write_chip(model::ChipConfig& chip, const Setting& setting) {
  try {
    model::set_parameter(chip, setting.key, setting.value, setting.origin);
  } catch (const model::ConfigError& error) {
    throw InputError(error.what());
  }
}

void write_run(RunSettings& run, const RunParameter& parameter, const Setting& setting) {
  if (!parameter.write(run, setting.value)) refuse(setting, parameter.allowed);
}

model::ChipConfig load(const std::string& chip, const std::string& origin) {
  try {
    return load_chip(chip);
  } catch (const model::ConfigError& error) {
    throw InputError(origin + error.what());
  } catch (const InputError& error) {
    throw InputError(origin + error.what());
  }
}

}  // namespace

model::ChipConfig load_chip(const std::string& preset_or_file) {
  return model::load_chip(preset_or_file, [](const std::string& file) {
    std::string text = read_input_file(file, "a readable TOML file", kMostTomlBytes);
    require_shallow_toml(text, file);
    return text;
  });
}

const std::vector<RunParameter>& run_parameter_table() {
  static const std::vector<RunParameter> table = declare();
  return table;
}

const RunParameter* find_run_parameter(const std::string& key) {
  for (const RunParameter& parameter : run_parameter_table())
    if (parameter.key == key) return &parameter;
  return nullptr;
}

bool is_setting(const std::string& key) {
  return find_run_parameter(key) != nullptr || model::find_parameter(key) != nullptr;
}

void require_allowed(const Setting& setting) {
  RunSettings run;
  if (const RunParameter* const parameter = find_run_parameter(setting.key)) {
    write_run(run, *parameter, setting);
    if (setting.key == "chip") load(setting.value, setting.origin + ": ");
  } else if (model::find_parameter(setting.key) != nullptr) {
    run.options.chip = model::default_chip_config();
    write_chip(run.options.chip, setting);
  } else {
    std::string known;
    for (const RunParameter& other : run_parameter_table()) known += other.key + ", ";
    throw InputError(setting.origin + ": found the key '" + setting.key +
                     "', which names no parameter; allowed: " + known +
                     "and the keys listed by 'csx600 params'");
  }
}

RunSettings make_settings(const std::vector<Setting>& settings) {
  RunSettings run;
  run.options.program = path_tracer::default_program();
  for (const Setting& setting : settings)
    if (const RunParameter* const parameter = find_run_parameter(setting.key))
      write_run(run, *parameter, setting);
  run.options.chip = load(run.chip, "");
  for (const Setting& setting : settings)
    if (find_run_parameter(setting.key) == nullptr) write_chip(run.options.chip, setting);
  run.options.level = widest_level();
  run.options.film_sums = FilmSums::means;  // a sweep and golden runs keep the image's hash only
  try {
    model::validate(run.options.chip);
    path_tracer::validate(run.options.program);
  } catch (const model::ConfigError& error) {
    throw InputError(error.what());
  } catch (const path_tracer::ProgramError& error) {
    throw InputError(error.what());
  }
  return run;
}

std::string value_of(const RunSettings& settings, const std::string& key) {
  if (const RunParameter* const parameter = find_run_parameter(key)) return parameter->read(settings);
  return model::parameter_text(settings.options.chip, key);
}

std::string stream_inputs(const RunSettings& settings) {
  std::string text;
  for (const RunParameter& parameter : run_parameter_table())
    if (parameter.effect == Effect::stream && parameter.key != "chip")
      text += parameter.key + " = " + parameter.read(settings) + "\n";
  for (const model::ParameterInfo& parameter : model::parameter_table())
    if (parameter.effect == Effect::stream)
      text += parameter.key + " = " + model::value_text(parameter.read(settings.options.chip)) + "\n";
  return text;
}

std::string all_inputs(const RunSettings& settings) {
  std::string text;
  for (const RunParameter& parameter : run_parameter_table())
    if (parameter.key != "scene" && parameter.key != "chip")
      text += parameter.key + " = " + parameter.read(settings) + "\n";
  return text + model::effective_toml(settings.options.chip);
}

}  // namespace testbench
