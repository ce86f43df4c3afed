#pragma once

#include <filesystem>
#include <optional>

#include "model/waves/wave_config.hpp"

namespace testbench {

/// The part of a run to record as waves, and the file for it.
struct WaveOptions {
  std::filesystem::path file;  ///< ends in ".vcd" or ".fst"
  model::WaveConfig config;
};

/// Outputs to write while a chip runs. None of them changes a cycle.
struct ObservationOptions {
  std::optional<WaveOptions> waves;
  std::filesystem::path transactions;  ///< an empty name writes no file
  std::filesystem::path timeline;

  bool any() const { return waves || !transactions.empty() || !timeline.empty(); }
};

}  // namespace testbench
