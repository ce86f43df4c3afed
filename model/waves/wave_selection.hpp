#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "model/waves/wave_signals.hpp"

namespace model {

/// Waves that cannot be recorded. The message is one line: what was found, what is allowed.
class WaveError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Which signals of a chip to show.
struct WaveSelection {
  std::vector<std::string> globs;       ///< shell patterns on paths; none: every path
  std::optional<WaveLevel> level;       ///< default: all levels with globs, units without
  std::optional<std::vector<int>> pes;  ///< the PEs shown one by one, whatever the level
};

/// The signals chosen, in the order of the table. Throws WaveError for a pattern that no signal of the chip
/// matches, a PE that it does not have, or if nothing is left.
std::vector<WaveInstance> select_waves(const ChipConfig& config, const WaveSelection& selection);

}  // namespace model
