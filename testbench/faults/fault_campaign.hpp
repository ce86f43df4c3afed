#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "model/faults/fault.hpp"
#include "testbench/faults/fault_outcome.hpp"
#include "testbench/faults/fault_store.hpp"
#include "testbench/run/render.hpp"

namespace testbench {

/// Many runs of a scene, each with one fault at a random time and place.
struct FaultCampaign {
  const Scene* scene;
  RenderOptions options;  ///< with the image; without faults
  std::vector<model::FaultKind> kinds;
  std::uint64_t seed;
};

/// What the run without faults says about where faults can be.
struct FaultFreeRun {
  std::vector<double> rgb;
  std::string image_sha256;
  model::Cycles firmware_cycles = 0;
  double cpu_seconds = 0;
};

/// Runs the scene without faults, in a process of its own. Throws as render_on_chip() does.
FaultFreeRun run_without_faults(const FaultCampaign& campaign, double limit_seconds);

/// The fault of a run: its kind in turn, its cycle uniform over the firmware's, its place uniform over the
/// bits of the unit: all of the PEs' SRAM, and of the DDR what scene and bins take. It depends on seed and
/// number only.
model::Fault fault_of_run(const FaultCampaign& campaign, const FaultFreeRun& fault_free,
                          std::uint64_t number);

/// Makes the runs 0 .. count - 1 that `store` does not have, each in a process of its own. A run that
/// takes four times the cycles of the one without faults is ended by the watchdog, unless the chip's is
/// sooner, and by the time limit after `limit_seconds`. Returns false when `progress` asked it to stop.
bool run_campaign(const FaultCampaign& campaign, const FaultFreeRun& fault_free, int count, int jobs,
                  double limit_seconds, FaultStore& store, const RenderProgress& progress);

}  // namespace testbench
