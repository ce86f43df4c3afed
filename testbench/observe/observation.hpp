#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "model/csx600.hpp"
#include "testbench/observe/observation_options.hpp"
#include "testbench/observe/timeline.hpp"
#include "testbench/observe/transaction_log.hpp"
#include "testbench/observe/wave_files.hpp"

namespace testbench {

/// Throws InputError if a file cannot be written, or nothing is selected.
void require_writable(const ObservationOptions& options, const model::ChipConfig& chip);

/// Attached to a chip before its run.
class Observation {
 public:
  /// Throws InputError.
  Observation(const ObservationOptions& options, model::Csx600& chip);

  /// After the run: completes each file. Returns what is wrong with those that are not, one line each, or an
  /// empty text: the run itself is not lost with them.
  std::string finish();

 private:
  std::optional<WaveFiles> waves_;
  std::optional<TransactionLog> transactions_;
  std::optional<Timeline> timeline_;
  model::ChipObservers observers_;
};

}  // namespace testbench
