#pragma once

#include <array>
#include <string>
#include <vector>

#include "testbench/run/render.hpp"

namespace testbench {

/// What became of a run with a fault.
enum class FaultOutcome : std::uint8_t {
  masked,          ///< the image is equal to the bit
  corrected,       ///< the same, and ECC had corrected a word
  slightly_wrong,  ///< no channel of a pixel is off by more than one 8-bit sRGB code
  wrong_pixels,
  detected,  ///< ECC stopped the run
  hang,      ///< the watchdog, the deadlock report or the time limit ended it
  stopped,   ///< another check did: an address outside memory, a sample that is no radiance
  crashed,   ///< the process died: the simulated program left its memory
};

struct FaultOutcomeInfo {
  const char* name;
  bool is_vulnerable;  ///< the user gets no right image
};

inline constexpr std::array<FaultOutcomeInfo, 8> kFaultOutcomes{{{"masked", false},
                                                                 {"corrected", false},
                                                                 {"slightly_wrong", true},
                                                                 {"wrong_pixels", true},
                                                                 {"detected", true},
                                                                 {"hang", true},
                                                                 {"stopped", true},
                                                                 {"crashed", true}}};

/// A run beside the one without faults.
struct FaultResult {
  FaultOutcome outcome = FaultOutcome::masked;
  int differing_pixels = 0;
  int largest_difference = 0;     ///< in 8-bit sRGB codes
  std::int64_t extra_cycles = 0;  ///< of the firmware, beside the run without faults
  std::string message;            ///< of a run that was stopped
};

/// @param fault_free Film::rgb() of the run without faults
FaultResult compare_with(const std::vector<double>& fault_free, const RenderResult& result);
/// What a run that threw this has come to.
FaultResult stopped_by(const std::string& message);

}  // namespace testbench
