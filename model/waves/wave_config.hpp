#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "model/time/cycles.hpp"
#include "model/waves/wave_selection.hpp"

namespace model {

/// Cycles [first, last).
struct CycleWindow {
  Cycles first = 0;
  Cycles last = std::numeric_limits<Cycles>::max();
};

/// Blocks `first` (counted from 1) to `first` + `count` - 1: from where the kernels of the first begin to
/// where those of the next block begin.
struct BlockWindow {
  std::uint64_t first = 1;
  std::uint64_t count = std::numeric_limits<std::uint64_t>::max();
};

struct WaveConfig {
  std::string chip =
      "csx600";  ///< root scope of the file: the chip's name, so that those of two can be told apart
  WaveSelection selection;
  /// What is recorded: the whole run when there is neither kind of window.
  std::vector<CycleWindow> windows;
  std::vector<BlockWindow> blocks;
};

/// Throws WaveError if the selection or a window is empty.
void check_waves(const WaveConfig& config, const ChipConfig& chip);

/// The windows for a message: "from cycle 100 to before cycle 200, from block 3 on".
std::string text_of_windows(const WaveConfig& config);

}  // namespace model
