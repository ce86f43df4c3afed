#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "model/config/chip_parameters.hpp"

namespace model {

/// A parameter that a preset sets: to another value than the default, or to the same for a reason of its own.
struct PresetOverride {
  std::string_view key;
  std::string_view value;  ///< as `--set` reads it
  Confidence confidence;
  std::string_view why;
};

/// A named chip: the defaults of the parameter table with these overrides.
struct Preset {
  std::string_view name;
  std::string_view summary;  ///< says what the preset assumes and does not model, too
  std::vector<PresetOverride> overrides;
};

const std::vector<Preset>& preset_table();

/// nullptr for an unknown name.
const Preset* find_preset(std::string_view name);

std::vector<std::string> preset_names();

/// Throws ConfigError, which lists the presets and begins with `origin` if there is one, for an unknown name.
ChipConfig preset(std::string_view name, std::string_view origin = {});

}  // namespace model
