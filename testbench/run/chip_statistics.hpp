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
#include "model/search_unit/search_statistics.hpp"

namespace model {
class Csx600;
}

namespace testbench {

/// Everything the chip counted in a run, copied out when it ended. Of a board, and of a chip with several
/// arrays, counts are sums (merge()), cycles by cause those of all control units together.
struct ChipStatistics {
  model::ChipConfig config;           ///< board.chips: of how many chips these are the counts
  model::Cycles firmware_cycles = 0;  ///< from the first firmware's start to the last one's end
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
  model::SearchStatistics search_unit;
  model::ClearConnectStatistics bus_search_unit;
  model::HostLinkStatistics host_link;

  /// Adds the counts of another chip, or of another array of this one, that ran beside it. `config` and both
  /// times stay.
  void merge(const ChipStatistics& other);

  int arrays() const { return config.board.chips * config.chip.arrays; }
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

/// From the start of the first array's firmware to the end of the last one's.
struct FirmwareSpan {
  model::Cycles start;
  model::Cycles end;

  model::Cycles cycles() const { return end - start; }
};
FirmwareSpan firmware_span(const model::Csx600& chip);

/// Of one chip.
/// @param total_cycles with upload and download
ChipStatistics collect_statistics(const model::Csx600& chip, model::Cycles total_cycles);

/// As counters.hpp declares the counters.
nlohmann::ordered_json to_json(const ChipStatistics& statistics);
nlohmann::ordered_json to_json(const path_tracer::RunCounts& counts);

}  // namespace testbench
