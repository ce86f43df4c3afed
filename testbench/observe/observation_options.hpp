#pragma once

#include <filesystem>
#include <optional>

#include "model/waves/wave_config.hpp"

namespace testbench {

/// Which part of a run to show as waves, and where.
struct WaveOptions {
  std::filesystem::path file;  ///< ends in ".vcd" or ".fst"
  model::WaveConfig config;
};

/// What to write down of a run on the chip while it goes on; none of it changes a cycle.
struct ObservationOptions {
  std::optional<WaveOptions> waves;
  std::filesystem::path transactions;  ///< empty: none
  std::filesystem::path timeline;

  bool any() const { return waves || !transactions.empty() || !timeline.empty(); }
};

}  // namespace testbench
