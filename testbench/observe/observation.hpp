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

/// Throws InputError if a file cannot be written or the selection of waves is empty.
void require_writable(const ObservationOptions& options, const model::ChipConfig& chip);

/// The files of one array: those of `options`, with the array's name before the extension where the board has
/// more than one: "a.csx600_1.vcd".
ObservationOptions observation_of_array(const ObservationOptions& options, const model::Csx600& chip,
                                        int array);

/// The outputs that are written while an array runs, and of the chip's first array those of what all share:
/// memories, network, host link. Must be constructed before the run.
class Observation {
 public:
  /// Throws InputError as require_writable() does.
  Observation(const ObservationOptions& options, model::Csx600& chip, int array = 0);

  /// Must be called after the run; completes each file. Does not throw, so that the run is not lost: returns
  /// one line for each file that is not complete, or an empty text.
  std::string finish();

 private:
  std::optional<WaveFiles> waves_;
  std::optional<TransactionLog> transactions_;
  std::optional<Timeline> timeline_;
  model::ChipObservers observers_;
};

}  // namespace testbench
