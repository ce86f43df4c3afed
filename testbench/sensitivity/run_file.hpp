#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "testbench/run/run_settings.hpp"

namespace testbench {

/// The settings that make the run of a statistics file again: scene, film, firmware, timing and each
/// parameter of its chip.
/// @param statistics as read_statistics() returns them
/// @param origin names the file
/// Throws InputError for a run that settings do not make: one with an importance map.
std::vector<Setting> settings_of_run(const nlohmann::ordered_json& statistics, const std::string& origin);

}  // namespace testbench
