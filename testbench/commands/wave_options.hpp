#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "model/config/chip_config.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/observe/observation_options.hpp"

namespace testbench {

/// What to write down of a run on the chip: --waves and what selects them, --transactions, --timeline.
class ObservationOption {
 public:
  void add_to(CLI::App& command);

  bool any() const { return !waves_.empty() || !transactions_.empty() || !timeline_.empty(); }
  /// The files, for require_files_of_their_own().
  std::vector<OutputOption> outputs() const;
  /// Throws InputError for what cannot be read as a window, a block or a PE.
  ObservationOptions options(const model::ChipConfig& chip) const;

 private:
  void require_waves() const;
  WaveOptions wave_options(const model::ChipConfig& chip) const;

  std::string waves_;
  std::vector<std::string> signals_;
  std::string level_;
  std::string pes_;
  std::vector<std::string> windows_;
  std::vector<std::string> blocks_;
  std::string transactions_;
  std::string timeline_;
};

}  // namespace testbench
