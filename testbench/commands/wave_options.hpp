#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "model/config/chip_config.hpp"
#include "model/waves/wave_signals.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/observe/observation_options.hpp"

namespace testbench {

/// What is recorded of a run on the chip: --waves and what selects them, --transactions, --timeline.
class ObservationOption {
 public:
  void add_to(CLI::App& command);

  bool any() const { return !waves_.empty() || !transactions_.empty() || !timeline_.empty(); }
  /// The files, with those that waves bring along, for OutputFiles::require_writable().
  std::vector<OutputOption> outputs() const;
  /// Throws InputError for what cannot be read as a window, a block or a PE.
  ObservationOptions options(const model::ChipConfig& chip) const;

 private:
  void require_waves() const;
  WaveOptions wave_options(const model::ChipConfig& chip) const;

  std::string waves_;
  std::vector<std::string> signals_;
  std::optional<model::WaveLevel> level_;
  std::string pes_;
  std::vector<std::string> windows_;
  std::vector<std::string> blocks_;
  std::string transactions_;
  std::string timeline_;
};

}  // namespace testbench
