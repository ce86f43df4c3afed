#pragma once

#include <array>

#include "model/config/timing_style.hpp"

namespace testbench {

/// As command line and files spell the timing styles, in the order of TimingStyle.
inline constexpr std::array kTimingNames = {"lt", "at"};

inline const char* timing_name(model::TimingStyle timing) {
  return kTimingNames.at(std::size_t(timing));
}

}  // namespace testbench
