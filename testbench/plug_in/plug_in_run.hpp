#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "firmware/plug_in/firmware.hpp"
#include "model/config/chip_config.hpp"
#include "model/config/timing_style.hpp"
#include "testbench/machine/timing_stream.hpp"
#include "testbench/observe/observation_options.hpp"
#include "testbench/run/chip_statistics.hpp"

namespace testbench {

/// What a run of a plug-in is asked to do beside the firmware's own options.
struct PlugInOptions {
  model::ChipConfig chip;
  model::TimingStyle timing = model::TimingStyle::loosely_timed;
  bool native = false;
  bool check_hazards = false;
  ObservationOptions observation;
};

struct PlugInResult {
  std::optional<ChipStatistics> chip;  ///< none of a native run
  double cpu_seconds = 0;              ///< of the simulator
  std::string observation_failures;
};

/// Prepares, uploads, runs, downloads and checks. Throws InputError for options that do not fit each other or
/// buffers that do not fit their memory, and RunError for a fault, a hazard, results that are wrong, and
/// whatever else the firmware throws.
PlugInResult run_plug_in(plug_in::Firmware& firmware, const PlugInOptions& options);

/// A firmware that was run once and its results checked, for other chips to be timed with.
struct PlugInRecording {
  std::unique_ptr<plug_in::Firmware> firmware;  ///< prepared, its counters set
  TimingStream stream;                          ///< what it asks of its machine
};

/// Runs natively and records. Throws as run_plug_in() does, and RunError for a firmware of several threads,
/// whose order of calls depends on the chip.
PlugInRecording record_plug_in(std::unique_ptr<plug_in::Firmware> firmware, const PlugInOptions& options);

/// What run_plug_in() would return, to the cycle and in every statistic, without executing a kernel. Only
/// parameters may differ from the recorded run's that cannot change its stream (ParameterInfo::effect).
PlugInResult replay_plug_in(const PlugInRecording& recording, const PlugInOptions& options);

/// What `csx600 run` writes: the firmware's options and what the chip counted.
nlohmann::ordered_json plug_in_statistics(const plug_in::Firmware& firmware, const PlugInOptions& options,
                                          const PlugInResult& result);

/// The same as a small table for people.
std::string plug_in_table(const plug_in::Firmware& firmware, const PlugInResult& result);

}  // namespace testbench
