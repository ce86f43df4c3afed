#pragma once

#include <nlohmann/json_fwd.hpp>

#include "model/config/chip_config.hpp"

namespace testbench {

/// Every parameter of the chip: "pio.setup_cycles" at ["pio"]["setup_cycles"].
nlohmann::ordered_json chip_config_json(const model::ChipConfig& chip);

}  // namespace testbench
