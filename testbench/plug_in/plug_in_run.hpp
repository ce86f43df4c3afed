#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "firmware/plug_in/firmware.hpp"
#include "model/config/chip_config.hpp"
#include "model/config/timing_style.hpp"
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
  std::string observation_failures;
};

/// Prepares, uploads, runs, downloads and checks. Throws InputError for options that do not fit each other or
/// buffers that do not fit mono memory, and RunError for a fault, a hazard and results that are wrong.
PlugInResult run_plug_in(plug_in::Firmware& firmware, const PlugInOptions& options);

inline constexpr const char* kPlugInStatisticsFormat = "csx600-run-1";

/// What `csx600 run` writes: the firmware's options and what the chip counted.
nlohmann::ordered_json plug_in_statistics(const plug_in::Firmware& firmware, const PlugInOptions& options,
                                          const PlugInResult& result);

/// The same as a small table for people.
std::string plug_in_table(const plug_in::Firmware& firmware, const PlugInResult& result);

}  // namespace testbench
