#include "testbench/commands/command_options.hpp"

#include <cstdio>
#include <filesystem>
#include <map>

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

void require_files_of_their_own(const std::vector<OutputOption>& outputs) {
  std::map<std::filesystem::path, std::string> option_of;
  for (const auto& [option, path] : outputs) {
    if (path.empty()) continue;
    const auto [other, is_first] =
        option_of.emplace(std::filesystem::absolute(path).lexically_normal(), option);
    if (!is_first)
      throw InputError(std::string(option) + ": found '" + path + "', which " + other->second +
                       " writes too; allowed is a file of its own");
  }
}

void ChipOptions::add_to(CLI::App& command, const std::string& default_chip) {
  chip_ = default_chip;
  command.add_option("--chip", chip_, "Preset or .toml file (see `csx600 params`)")->capture_default_str();
  command.add_option("--set", settings_, "One parameter, key=value; may be repeated")
      ->allow_extra_args(false);
}

model::ChipConfig ChipOptions::chip() const {
  try {
    model::ChipConfig config = model::load_chip(chip_);
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
