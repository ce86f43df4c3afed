#pragma once

#include <string>
#include <vector>

#include "model/config/chip_config.hpp"

namespace testbench {

/// The area of a chip by its parts, to first order: numbers of parts times the parameters area.*, scaled
/// from 130 nm to the chip's process.
struct Area {
  struct Part {
    std::string name;
    double mm2;
  };
  std::vector<Part> parts;

  double mm2() const;
};

/// Of one chip.
Area area_of(const model::ChipConfig& config);

}  // namespace testbench
