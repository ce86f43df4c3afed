#include "model/config/chip_presets.hpp"

#include "model/config/paper_constants.hpp"

namespace model {
namespace {

constexpr Confidence kVendor = Confidence::vendor;
constexpr Confidence kStated = Confidence::stated;
constexpr Confidence kInferred = Confidence::inferred;
constexpr Confidence kAssumed = Confidence::assumed;

Preset csx600() {
  return {"csx600", "one CSX600 of a shipped X620/e620 board, 210 MHz: the defaults", {}};
}

// Latencies in cycles stay: chip and memory interface share the clock [S7].
Preset csx600_250mhz() {
  return {"csx600_250mhz",
          "one CSX600 at its design clock",
          {{"chip.clock_hz", "250000000", kVendor, "design clock [S5, S9]"},
           {"ddr.refresh_interval_cycles", "1950", kInferred, "7.8 us at 250 MHz [JESD79-2]"},
           {"ddr.refresh_cycles", "27", kInferred, "105 ns at 250 MHz, rounded up [JESD79-2]"},
           {"board.bridge_clock_hz", "250000000", kAssumed, "as the chip's"},
           {"host.latency_cycles", "2500", kAssumed, "10 us at 250 MHz"}}};
}

Preset csx700() {
  return {
      "csx700",
      "CSX700 of an e710 card, for exploration: two arrays of 96 PEs on one network that share its memories, "
      "each array as the CSX600's (assumed)",
      {{"chip.clock_hz", "250000000", kInferred, "96 GFLOPS [S11] / (192 PEs x 2)"},
       {"chip.arrays", "2", kInferred, "96 GFLOPS [S11] at 250 MHz are those of 192 PEs: two arrays of 96"},
       {"board.bridge_clock_hz", "250000000", kAssumed, "as the chip's"},
       {"ddr.size_bytes", "2147483648", kVendor, "2 GB of DDR2-533 on the e710 card [S11]"},
       {"ddr.banks", "8", kAssumed, "two channels of 4 banks; number of channels not published"},
       {"ddr.bytes_per_cycle", "34", kInferred,
        "two channels of 64-bit DDR2-533, 4.27 GB/s each, at 250 MHz, rounded down; two channels assumed"},
       {"ddr.refresh_interval_cycles", "1950", kInferred, "7.8 us at 250 MHz [JESD79-2]"},
       {"ddr.refresh_cycles", "32", kInferred,
        "127.5 ns at 250 MHz, rounded up, tRFC of 1 Gbit devices [JESD79-2], device size assumed"},
       {"host.bytes_per_second", "2000000000", kInferred,
        "PCI Express x8 [S11] at 250 MB/s a lane; first generation assumed"},
       {"host.latency_cycles", "2500", kAssumed, "10 us at 250 MHz"}}};
}

// Double-single arithmetic from single-precision operations without a fused multiply-add: add 20 (2 two-sums
// of 6, 2 adds, 2 quick two-sums of 3), multiply 24 (two-product of 17 by splitting, 2 multiplies, 2 adds,
// quick two-sum of 3), each operation taking 4 cycles as fp32_add does.
Preset g80_like() {
  constexpr std::string_view kRoutine =
      "csx600's cycles x 22, the mean of the add's and multiply's 20 and 24";
  constexpr std::string_view kByMemory =
      "no inter-PE path: a write and a read of memory, 2 x (60 for a page miss + 16 for 32 x 8 bytes)";
  return {
      "g80_like",
      "what the paper says about G80, for exploration: 32 wide, double precision by several single-precision "
      "operations, no inter-PE path, results leave by memory; all costs assumed, everything else (clock, "
      "memory, "
      "PIO, SRAM) as csx600 so that only the structure differs; warps hiding latency are not modelled",
      {{"chip.pes", "32", kStated, "a warp of 32 threads runs as one SIMD instruction [paper]"},
       {"poly.cycles.fp64_add", "80", kAssumed, "20 single-precision operations of 4 cycles"},
       {"poly.cycles.fp64_mul", "96", kAssumed, "24 single-precision operations of 4 cycles"},
       {"poly.cycles.fp64_div", "236", kAssumed,
        "first quotient 24, product 96, difference 80, second quotient 24, quick two-sum 12"},
       {"poly.cycles.fp64_sqrt", "240", kAssumed,
        "first root 28, square 96, difference 80, correction by a quotient 24, quick two-sum 12"},
       {"poly.cycles.fp64_sincos", "2420", kAssumed, kRoutine},
       {"poly.cycles.fp64_exp", "1980", kAssumed, kRoutine},
       {"poly.cycles.fp64_log", "1980", kAssumed, kRoutine},
       {"poly.cycles.fp64_atan2", "2420", kAssumed, kRoutine},
       {"poly.cycles.fp64_add_vector4", "80", kAssumed, "4 x 20 single-precision operations, 1 a cycle"},
       {"poly.cycles.fp64_mul_vector4", "96", kAssumed, "4 x 24 single-precision operations, 1 a cycle"},
       {"poly.cycles.fp64_multiply_add_vector4", "176", kAssumed, "a multiply, then an add"},
       {"poly.cycles.swazzle", "152", kAssumed, kByMemory},
       {"poly.cycles.swazzle_vector4", "248", kAssumed,
        "no inter-PE path: a write and a read of memory, 2 x (60 + 4 x 16 for 32 x 8 bytes each)"},
       {"poly.cycles.reduce", "152", kAssumed, kByMemory}}};
}

/// The paper's fitted constants: the only numbers of the model that are fitted to the paper's Tables 1 and 2,
/// on three of the 24 cells (`csx600 calibrate`).
std::vector<PresetOverride> paper_fitted_constants() {
  return {{"poly.code_quality_factor", kPaperCodeQualityFactor, kInferred,
           "fitted to segments, n = 1: the paper's code is \"not optimised\" (paper, section 5)"},
          {"pio.per_pe_cycles", kPaperPerPeCycles, kInferred, "fitted to segments, n = 0"},
          {"control.transfer_call_cycles", kPaperTransferCallCycles, kInferred,
           "fitted to direct, n = 1: software overhead of small transfers is measured [S13]"}};
}

Preset paper() {
  Preset preset{
      "paper",
      "the chip of the paper's tables: one CSX600 at 210 MHz; the paper states neither clock nor chips used",
      {{"chip.clock_hz", "210000000", kAssumed, "not stated by the paper; clock of shipped boards [S7]"},
       {"chip.pes", "96", kAssumed, "the paper does not say whether both chips of the board worked; one"}}};
  for (const PresetOverride& constant : paper_fitted_constants()) preset.overrides.push_back(constant);
  return preset;
}

std::string listed_presets() {
  std::string list;
  for (const Preset& preset : preset_table()) list += (list.empty() ? "" : ", ") + std::string(preset.name);
  return list;
}

}  // namespace

const std::vector<Preset>& preset_table() {
  static const std::vector<Preset> table = {csx600(), csx600_250mhz(), csx700(), g80_like(), paper()};
  return table;
}

const Preset* find_preset(std::string_view name) {
  for (const Preset& preset : preset_table()) {
    if (preset.name == name) return &preset;
  }
  return nullptr;
}

std::vector<std::string> preset_names() {
  std::vector<std::string> names;
  for (const Preset& preset : preset_table()) names.emplace_back(preset.name);
  return names;
}

ChipConfig preset(std::string_view name, std::string_view origin) {
  const Preset* found = find_preset(name);
  if (!found) {
    throw ConfigError((origin.empty() ? "" : std::string(origin) + ": ") + "unknown preset '" +
                      std::string(name) + "'; allowed: " + listed_presets());
  }
  ChipConfig config = default_chip_config();
  config.preset = found->name;
  const std::string set_by = "preset " + config.preset;
  for (const PresetOverride& set : found->overrides) set_parameter(config, set.key, set.value, set_by);
  validate(config, set_by);
  return config;
}

}  // namespace model
