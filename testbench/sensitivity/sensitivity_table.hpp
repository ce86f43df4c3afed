#pragma once

#include <string>

#include "testbench/sensitivity/sensitivity.hpp"

namespace testbench {

/// Which figure puts parameters in order.
enum class SensitivityOrder : std::uint8_t { time, energy };

/// A line for each changed chip, parameters with the largest effect first, for people.
/// @param most parameters that are shown
std::string sensitivity_text(const Sensitivity& sensitivity, SensitivityOrder order, int most);

/// key,unit,value,kind,changed_to,cycles,seconds,joules,time_change,energy_change,error; changes are shares.
std::string sensitivity_csv(const Sensitivity& sensitivity, SensitivityOrder order);

/// The section `sensitivity` of a statistics file: the parameters in order, each with its changed runs.
nlohmann::ordered_json sensitivity_json(const Sensitivity& sensitivity, SensitivityOrder order);

}  // namespace testbench
