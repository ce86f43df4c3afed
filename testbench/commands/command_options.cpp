#include "testbench/commands/command_options.hpp"

#include <cstdio>

#include "model/chip_file.hpp"
#include "model/chip_parameters.hpp"
#include "testbench/error.hpp"
#include "testbench/render.hpp"

namespace testbench {
namespace {

constexpr int kMaxFilmSide = 16384;

}  // namespace

FilmSize parse_film_size(const std::string& text) {
  long long width = 0;
  long long height = 0;
  char end = 0;
  const bool two_numbers = std::sscanf(text.c_str(), "%lldx%lld%c", &width, &height, &end) == 2;
  const auto allowed = [](long long side) { return side >= 1 && side <= kMaxFilmSide; };
  if (!two_numbers || !allowed(width) || !allowed(height))
    throw InputError("--size: found '" + text + "', allowed is WIDTHxHEIGHT, each 1 to " +
                     std::to_string(kMaxFilmSide));
  return {static_cast<int>(width), static_cast<int>(height)};
}

void SetOptions::add_to(CLI::App& command) {
  command.add_option("--set", settings_, "One parameter, key=value; may be repeated")
      ->allow_extra_args(false);
}

void ChipOptions::add_to(CLI::App& command, const std::string& default_chip) {
  chip_ = default_chip;
  command.add_option("--chip", chip_, "Preset or .toml file (see `csx600 params`)")->capture_default_str();
  settings_.add_to(command);
}

model::ChipConfig SetOptions::chip(const std::string& name) const {
  try {
    model::ChipConfig config = model::load_chip(name);
    for (const std::string& setting : settings_) {
      const std::size_t equals = setting.find('=');
      if (equals == std::string::npos)
        throw InputError("--set: found '" + setting + "', allowed is key=value");
      model::set_parameter(config, setting.substr(0, equals), setting.substr(equals + 1), "--set");
    }
    model::validate(config);
    return config;
  } catch (const model::ConfigError& error) {
    throw InputError(error.what());
  }
}

void TimingOption::add_to(CLI::App& command) {
  command
      .add_option("--timing", text_,
                  "lt: loosely timed, fast; at: approximately timed, packet by packet in SystemC time")
      ->check(CLI::IsMember({"lt", "at"}))
      ->capture_default_str();
}

model::TimingStyle TimingOption::style() const {
  return text_ == "at" ? model::TimingStyle::approximately_timed : model::TimingStyle::loosely_timed;
}

void LevelOption::add_to(CLI::App& command) {
  command.add_option("--level", level_, "x86-64 level of the kernels: auto, v2, v3 or v4")
      ->check(CLI::IsMember({"auto", "v2", "v3", "v4"}))
      ->capture_default_str();
}

path_tracer::Level LevelOption::level() const {
  using path_tracer::Level;
  const Level widest = widest_level();
  if (level_ == "auto") return widest;
  const Level wanted = level_ == "v4"   ? Level::x86_64_v4
                       : level_ == "v3" ? Level::x86_64_v3
                                        : Level::x86_64_v2;
  if (wanted > widest)
    throw InputError("--level: found " + level_ + ", this machine executes levels up to v" +
                     std::to_string(2 + static_cast<int>(widest)));
  return wanted;
}

}  // namespace testbench
