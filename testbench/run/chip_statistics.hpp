#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "firmware/path_tracer/program/run_counts.hpp"
#include "model/config/chip_config.hpp"
#include "model/control/control_statistics.hpp"
#include "model/host_link/host_link_statistics.hpp"
#include "model/memory/ddr_timing.hpp"
#include "model/memory/on_chip_sram_timing.hpp"
#include "model/network/clear_connect_timing.hpp"
#include "model/observe/pio_observer.hpp"
#include "model/pe_array/kernel_statistics.hpp"
#include "model/pe_array/poly_sram_statistics.hpp"

namespace model {
class Csx600;
}

namespace testbench {

/// Everything the chip counted in a run, copied out when it ended.
struct ChipStatistics {
  model::ChipConfig config;
  model::Cycles firmware_cycles = 0;  ///< from the firmware's start to its end
  model::Cycles total_cycles = 0;     ///< with upload and download
  model::ControlStatistics control;
  std::vector<model::KernelStatistics> kernels;
  model::KernelStatistics all_kernels;
  model::PioStatistics pio;
  model::PolySramStatistics poly_sram;
  model::DdrStatistics ddr;
  model::OnChipSramStatistics on_chip_sram;
  model::ClearConnectStatistics bus_pio;
  model::ClearConnectStatistics bus_control;
  model::ClearConnectStatistics bus_host;
  model::HostLinkStatistics host_link;

  double seconds() const { return double(firmware_cycles) / config.chip.clock_hz; }
  /// The same with upload and download.
  double total_seconds() const { return double(total_cycles) / config.chip.clock_hz; }
  /// Share of the run in which the PE array executed kernels.
  double pe_utilisation() const;
  double simd_efficiency() const { return all_kernels.simd_efficiency(config.chip.pes); }
  /// Share of the run in which the control unit only waited for programmed I/O.
  double exposed_pio_share() const;
  double ddr_bytes_per_second() const;
};

ChipStatistics collect_statistics(const model::Csx600& chip, model::Cycles total_cycles);

/// As counters.hpp declares the counters.
nlohmann::ordered_json to_json(const ChipStatistics& statistics);
nlohmann::ordered_json to_json(const path_tracer::RunCounts& counts);

}  // namespace testbench
