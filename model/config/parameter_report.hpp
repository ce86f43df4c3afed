#pragma once

#include <string>

#include "model/config/chip_parameters.hpp"

namespace model {

/// What `csx600 params` prints. The confidence is that of the value: of the default or of the preset's
/// override; "user" where the value is neither.

/// Columns key, value, unit, confidence and meaning, a parameter a line, then the sources.
std::string parameter_text_report(const ChipConfig& config);

/// A JSON array of objects with key, value, unit, confidence, meaning, default and allowed, and for a value
/// that the preset gives, `preset_reason`.
std::string parameter_json_report(const ChipConfig& config);

/// A Markdown table of key, value, unit, confidence, range and meaning, and one of the sources.
std::string parameter_markdown(const ChipConfig& config);

/// Every preset with its overrides and their reasons.
std::string preset_text_report();

}  // namespace model
