#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

/// What `csx600 params` says of the firmware's options; all of it from their table (program_options.hpp).
namespace testbench {

/// Columns key, default, unit, allowed and meaning, an option a line.
std::string option_text_report();

/// A JSON array of objects with key, group, unit, default, allowed, meaning and, for an option that `csx600
/// render` chooses, `chosen`.
nlohmann::ordered_json option_json_report();

/// A Markdown table for each group, under headings of the third level.
std::string option_markdown();

}  // namespace testbench
