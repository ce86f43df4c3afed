#pragma once

#include <cstdint>

namespace model {

/// How the chip's units spend time; an option of a run, not of the chip. Images are equal, cycles nearly so.
enum class TimingStyle : std::uint8_t {
  loosely_timed,        ///< requests are booked whole on time lines, ahead of SystemC time
  approximately_timed,  ///< packets cross the chip in SystemC time, by the four phases of TLM-2.0
};

}  // namespace model
