#include "testbench/sweep/run_settings.hpp"

#include <algorithm>
#include <charconv>

#include "model/config/chip_file.hpp"
#include "testbench/film/film_size.hpp"
#include "testbench/run/program_names.hpp"
#include "testbench/run/sampling_choice.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using model::Effect;
using path_tracer::ProgramConfig;
using path_tracer::TreeShape;
using Values = std::vector<std::string>;

constexpr int kMostSamples = 1 << 20;

template <class Number>
std::optional<Number> parse(const std::string& text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

bool write_integer(int& field, const std::string& text, int low, int high) {
  const std::optional<int> number = parse<int>(text);
  if (!number || *number < low || *number > high) return false;
  field = *number;
  return true;
}

/// Writes the place of `text` in `names`.
template <class Enumeration>
bool write_choice(Enumeration& field, const std::string& text, const Values& names) {
  const auto found = std::find(names.begin(), names.end(), text);
  if (found == names.end()) return false;
  field = Enumeration(found - names.begin());
  return true;
}

std::string one_of(const Values& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "one of " : ", ") + name;
  return text;
}

std::string integers(int low, int high) {
  return "an integer from " + std::to_string(low) + " to " + std::to_string(high);
}

const Values& program_names() {
  static const Values names = {"segments", "direct", "full"};
  return names;
}
const Values& buffer_names() {
  static const Values names = {"none", "loads", "saves", "both"};
  return names;
}
const Values& sampler_names() {
  static const Values names = {"philox", "sobol"};
  return names;
}
const Values& light_sampling_names() {
  static const Values names = {"area", "solid_angle"};
  return names;
}
const Values& shadow_ray_names() {
  static const Values names = {"all", "facing"};
  return names;
}
const Values& timing_names() {
  static const Values names = {"lt", "at"};
  return names;
}

template <int TreeShape::*member, int low, int high>
RunParameter tree_integer(const std::string& name) {
  return {"firmware." + name, integers(low, high), Effect::stream,
          [](RunSettings& run, const std::string& text) {
            return write_integer(run.options.program.tree.*member, text, low, high);
          },
          [](const RunSettings& run) { return std::to_string(run.options.program.tree.*member); }};
}

RunParameter node_format() {
  return {"firmware.node_format", one_of(node_format_names()), Effect::stream,
          [](RunSettings& run, const std::string& value) {
            return write_choice(run.options.program.tree.layout.format, value, node_format_names());
          },
          [](const RunSettings& run) {
            return node_format_names()[std::size_t(run.options.program.tree.layout.format)];
          }};
}

RunParameter node_width() {
  static const Values widths = [] {
    Values names;
    for (const int width : path_tracer::kNodeWidth) names.push_back(std::to_string(width));
    return names;
  }();
  return {"firmware.node_width", one_of(widths), Effect::stream,
          [](RunSettings& run, const std::string& value) {
            if (std::find(widths.begin(), widths.end(), value) == widths.end()) return false;
            run.options.program.tree.layout.width = std::stoi(value);
            return true;
          },
          [](const RunSettings& run) { return std::to_string(run.options.program.tree.layout.width); }};
}

template <int ProgramConfig::*member, int low, int high>
RunParameter firmware_integer(const std::string& name) {
  return {"firmware." + name, integers(low, high), Effect::stream,
          [](RunSettings& run, const std::string& text) {
            return write_integer(run.options.program.*member, text, low, high);
          },
          [](const RunSettings& run) { return std::to_string(run.options.program.*member); }};
}

template <auto member, const Values& names()>
RunParameter firmware_choice(const std::string& name) {
  return {"firmware." + name, one_of(names()), Effect::stream,
          [](RunSettings& run, const std::string& text) {
            return write_choice(run.options.program.*member, text, names());
          },
          [](const RunSettings& run) { return names()[std::size_t(run.options.program.*member)]; }};
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
  return {"samples", integers(1, kMostSamples), Effect::stream,
          [](RunSettings& run, const std::string& value) {
            return write_integer(run.options.work.samples, value, 1, kMostSamples);
          },
          [](const RunSettings& run) { return std::to_string(run.options.work.samples); }};
}

RunParameter timing() {
  return {"timing", one_of(timing_names()), Effect::timing,
          [](RunSettings& run, const std::string& value) {
            return write_choice(run.options.timing, value, timing_names());
          },
          [](const RunSettings& run) { return timing_names()[std::size_t(run.options.timing)]; }};
}

RunParameter buffer() {
  return {"firmware.buffer", one_of(buffer_names()), Effect::stream,
          [](RunSettings& run, const std::string& value) {
            int which = 0;
            if (!write_choice(which, value, buffer_names())) return false;
            run.options.program.buffer_loads = (which & 1) != 0;
            run.options.program.buffer_saves = (which & 2) != 0;
            return true;
          },
          [](const RunSettings& run) {
            const ProgramConfig& program = run.options.program;
            return buffer_names()[std::size_t(program.buffer_loads) + 2 * std::size_t(program.buffer_saves)];
          }};
}

RunParameter max_survival() {
  return {"firmware.max_survival", "a number above 0 and below 1", Effect::stream,
          [](RunSettings& run, const std::string& value) {
            const std::optional<double> number = parse<double>(value);
            if (!number || !(*number > 0 && *number < 1)) return false;
            run.options.program.max_survival = *number;
            return true;
          },
          [](const RunSettings& run) { return model::value_text(run.options.program.max_survival); }};
}

RunParameter seed() {
  return {"firmware.seed", "an integer from 0 to 18446744073709551615", Effect::stream,
          [](RunSettings& run, const std::string& value) {
            const std::optional<std::uint64_t> number = parse<std::uint64_t>(value);
            if (number) run.options.program.seed = *number;
            return number.has_value();
          },
          [](const RunSettings& run) { return std::to_string(run.options.program.seed); }};
}

std::vector<RunParameter> declare() {
  return {name<&RunSettings::scene>("scene", "a directory with a scene.toml, or a .toml file"),
          name<&RunSettings::chip>("chip", "a preset of `csx600 params --presets` or a .toml file"),
          size(),
          samples(),
          timing(),
          firmware_choice<&ProgramConfig::program, program_names>("program"),
          firmware_integer<&ProgramConfig::n, 0, path_tracer::kMaxBuffers>("n"),
          buffer(),
          firmware_integer<&ProgramConfig::bin_blocks, 1, path_tracer::kMaxBinBlocks>("bin_blocks"),
          firmware_integer<&ProgramConfig::slot_vertices, path_tracer::kVerticesPerLoad,
                           path_tracer::kMaxSlotVertices>("slot_vertices"),
          firmware_choice<&ProgramConfig::cull_shadow_rays, shadow_ray_names>("shadow_rays"),
          firmware_choice<&ProgramConfig::sampler, sampler_names>("sampler"),
          firmware_choice<&ProgramConfig::light_sampling, light_sampling_names>("light_sampling"),
          firmware_integer<&ProgramConfig::roulette_start, 0, 1 << 20>("roulette_start"),
          max_survival(),
          seed(),
          firmware_integer<&ProgramConfig::pixel_stride, 1, 1 << 30>("pixel_stride"),
          firmware_choice<&ProgramConfig::traversal, traversal_names>("traversal"),
          node_format(),
          node_width(),
          tree_integer<&TreeShape::leaf_triangles, 1, path_tracer::kMaxLeafTriangles>("leaf_triangles"),
          tree_integer<&TreeShape::treelet_nodes, 1, path_tracer::kMaxTreeletNodes>("treelet_nodes"),
          tree_integer<&TreeShape::resident_nodes, 1, path_tracer::kMaxTreeletNodes>("resident_nodes"),
          tree_integer<&TreeShape::stack_entries, 0, path_tracer::kMaxStackEntries>("stack_entries"),
          tree_integer<&TreeShape::visits, 0, path_tracer::kMaxVisits>("visits")};
}

void refuse(const Setting& setting, const std::string& allowed) {
  throw InputError(setting.origin + ": " + setting.key + ": found '" + setting.value +
                   "'; allowed: " + allowed);
}

/// What the chip's own table says of a setting, as an error of the input.
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
    return model::load_chip(chip);
  } catch (const model::ConfigError& error) {
    throw InputError(origin + error.what());
  }
}

}  // namespace

const std::vector<RunParameter>& run_parameter_table() {
  static const std::vector<RunParameter> table = declare();
  return table;
}

const RunParameter* find_run_parameter(const std::string& key) {
  for (const RunParameter& parameter : run_parameter_table())
    if (parameter.key == key) return &parameter;
  return nullptr;
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
  choose_best_sampling(run.options.program);
  for (const Setting& setting : settings)
    if (const RunParameter* const parameter = find_run_parameter(setting.key))
      write_run(run, *parameter, setting);
  run.options.chip = load(run.chip, "");
  for (const Setting& setting : settings)
    if (find_run_parameter(setting.key) == nullptr) write_chip(run.options.chip, setting);
  run.options.level = widest_level();
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
