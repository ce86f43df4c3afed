#include <utility>

#include "firmware/cn/chip/lane_mask.hpp"
#include "model/config/chip_parameters.hpp"
#include "model/config/parameter_declaration.hpp"

namespace model {
namespace {

using cn::InstructionClass;

/// Marks a parameter that firmware sees: another value changes what it does, not only when.
ParameterInfo seen_by_firmware(ParameterInfo parameter) {
  parameter.effect = Effect::stream;
  return parameter;
}

/// An entry of the cost table.
template <InstructionClass c>
ParameterInfo cycles(double default_value, Confidence confidence, std::string meaning) {
  constexpr std::size_t kIndex = static_cast<std::size_t>(c);
  return {
      "poly.cycles." + std::string(cn::kInstructionClassNames[kIndex]),
      c == InstructionClass::sram ? "cycles/word" : "cycles",
      default_value,
      RealRange{0, 100000},
      confidence,
      std::move(meaning),
      [](const ChipConfig& config) { return to_value(config.poly.cycles[kIndex]); },
      [](ChipConfig& config, const ParameterValue& value) { from_value(value, config.poly.cycles[kIndex]); }};
}

using Parameters = std::vector<ParameterInfo>;

// Ranges end where the model would overflow or a sweep makes no sense any more, not where the silicon did.
constexpr std::int64_t kMaxCycles = 1'000'000;

void declare_chip(Parameters& table) {
  constexpr auto group = &ChipConfig::chip;
  using Chip = ChipConfig::Chip;
  table.push_back(real<group, &Chip::clock_hz>("chip.clock_hz", "Hz", 210e6, {1e6, 1e10}, Confidence::stated,
                                               "clock of the chip and of its memory interface; shipped "
                                               "X620/e620 boards 210 MHz [S7], design 250 MHz [S5]"));
  table.push_back(seen_by_firmware(
      integer<group, &Chip::pes>("chip.pes", "PEs", 96, {cn::kStripLanes, cn::kMaxPes, cn::kStripLanes},
                                 Confidence::vendor, "processing elements of an array [S1]")));
  table.push_back(seen_by_firmware(
      integer<group, &Chip::arrays>("chip.arrays", "arrays", 1, {1, 4}, Confidence::vendor,
                                    "arrays of PEs on one network, each with a control unit and a PIO "
                                    "engine of its own: one [S1]")));
  table.push_back(integer<group, &Chip::watchdog_cycles>(
      "chip.watchdog_cycles", "cycles", 0, {0, std::int64_t{1} << 60}, Confidence::assumed,
      "the longest that firmware may run before the run ends as failed; 0: no watchdog"));
}

void declare_poly(Parameters& table) {
  constexpr auto group = &ChipConfig::poly;
  using Poly = ChipConfig::Poly;
  table.push_back(seen_by_firmware(integer<group, &Poly::sram_bytes>(
      "poly.sram_bytes", "bytes/PE", 6144, {64, 262144, 8}, Confidence::vendor,
      "local memory of a PE [S5, S7]; the top 16 bytes are reserved by the ABI [S3]")));
  table.push_back(real<group, &Poly::code_quality_factor>(
      "poly.code_quality_factor", "-", 1, {0.01, 100}, Confidence::assumed,
      "cycles of code, poly or mono, = this x (instructions . cost table); 1 takes the table as it is"));
  table.push_back({"poly.vector_loads_overlap", "-", true, TrueOrFalse{}, Confidence::inferred,
                   "vector loads go on beside vector arithmetic, the longer counts: a scoreboard orders them "
                   "[S15e], and of "
                   "3 read and 2 write ports [S8] a multiply-add leaves one write",
                   &Field<group, &Poly::vector_loads_overlap>::read,
                   &Field<group, &Poly::vector_loads_overlap>::write});
}

void declare_floating_point_cycles(Parameters& table) {
  constexpr Confidence assumed = Confidence::assumed;
  const std::string latency =
      "; scalar code waits for the latency [reference, section 1], vector code issues 1 a cycle";
  const std::string no_unit = "; the PE has an adder and a multiplier only [reference, section 1]";
  const std::string routine = ", library routine [reference, section 6.3]";
  table.push_back(
      cycles<InstructionClass::fp64_add>(4, assumed, "double add, subtract, compare, minimum" + latency));
  table.push_back(cycles<InstructionClass::fp64_mul>(4, assumed, "double multiply" + latency));
  table.push_back(cycles<InstructionClass::fp64_div>(40, assumed, "double divide" + no_unit));
  table.push_back(cycles<InstructionClass::fp64_sqrt>(50, assumed, "double square root" + no_unit));
  table.push_back(
      cycles<InstructionClass::fp64_sincos>(110, assumed, "double sine and cosine of one angle" + routine));
  table.push_back(cycles<InstructionClass::fp64_exp>(90, assumed, "double exponential" + routine));
  table.push_back(cycles<InstructionClass::fp64_log>(90, assumed, "double logarithm" + routine));
  table.push_back(cycles<InstructionClass::fp64_atan2>(
      110, assumed, "double angle of a point, taken as sine and cosine" + routine));
  table.push_back(cycles<InstructionClass::fp32_add>(
      4, assumed,
      "float add, subtract, compare; the rate equals double's [S1], so does the assumed latency"));
  table.push_back(cycles<InstructionClass::fp32_mul>(4, assumed, "float multiply; as fp32_add"));
  table.push_back(cycles<InstructionClass::fp32_div>(24, assumed, "float divide" + no_unit));
  table.push_back(cycles<InstructionClass::fp32_sqrt>(28, assumed, "float square root" + no_unit));
}

void declare_vector_cycles(Parameters& table) {
  constexpr Confidence assumed = Confidence::assumed;
  const std::string meaning =
      " of a vector of 4: one element a cycle, which scalar code does not reach [reference, section 1]";
  const std::string both =
      " of a vector of 4: adder and multiplier work in the same clock, not fused [S7, S8]; one element a "
      "cycle "
      "[reference, section 1]";
  table.push_back(cycles<InstructionClass::fp64_add_vector4>(4, assumed, "double add" + meaning));
  table.push_back(cycles<InstructionClass::fp64_mul_vector4>(4, assumed, "double multiply" + meaning));
  table.push_back(
      cycles<InstructionClass::fp64_multiply_add_vector4>(4, assumed, "double multiply and add" + both));
  table.push_back(cycles<InstructionClass::fp32_add_vector4>(
      4, assumed, "float add" + meaning + "; the rate equals double's [S1]"));
  table.push_back(
      cycles<InstructionClass::fp32_mul_vector4>(4, assumed, "float multiply; as fp32_add_vector4"));
  table.push_back(cycles<InstructionClass::fp32_multiply_add_vector4>(
      4, assumed, "float multiply and add; as fp64_multiply_add_vector4"));
}

void declare_integer_cycles(Parameters& table) {
  table.push_back(cycles<InstructionClass::int16_alu>(
      1, Confidence::inferred, "16-bit add, logic, shift, compare: width of the PE's ALU [S9]"));
  table.push_back(cycles<InstructionClass::int32_alu>(
      2, Confidence::inferred, "32-bit add, logic, shift, compare: 2 passes of the 16-bit ALU"));
  table.push_back(cycles<InstructionClass::int64_alu>(
      4, Confidence::inferred, "64-bit add, logic, shift, compare: 4 passes of the 16-bit ALU"));
  table.push_back(cycles<InstructionClass::int16_mul>(
      2, Confidence::assumed,
      "16-bit multiply in the integer multiply-accumulate unit [S10]; cycles assumed"));
  table.push_back(
      cycles<InstructionClass::int32_mul>(6, Confidence::assumed, "32-bit multiply [reference, section 1]"));
  table.push_back(
      cycles<InstructionClass::int64_mul>(24, Confidence::assumed, "64-bit multiply: 4 of 32 bit"));
}

void declare_array_cycles(Parameters& table) {
  table.push_back(cycles<InstructionClass::move>(
      2, Confidence::assumed,
      "register move or masked assignment of 8 bytes, 4 bytes a cycle as the SRAM path"));
  table.push_back(cycles<InstructionClass::convert>(
      4, Confidence::assumed, "conversion between number formats, taken as a pass of the adder"));
  table.push_back(cycles<InstructionClass::enable>(
      1, Confidence::assumed, "push, invert or pop of the enable stack [reference, section 9]"));
  table.push_back(cycles<InstructionClass::sram>(
      1, Confidence::inferred, "4-byte word between SRAM and registers: 96 GB/s [S5] / (96 PEs x 250 MHz)"));
  table.push_back(cycles<InstructionClass::sram_vector_load>(
      1, Confidence::inferred,
      "4-byte word of a vector load; the same path as sram [S5], see poly.vector_loads_overlap"));
  table.push_back(cycles<InstructionClass::swazzle>(
      2, Confidence::assumed, "step of 8 bytes to the neighbouring PE [reference, section 9]"));
  table.push_back(
      cycles<InstructionClass::swazzle_vector4>(4, Confidence::assumed,
                                                "step of 4 x 8 bytes to the neighbouring PE: 8 bytes a "
                                                "cycle, the latency once [reference, section 1]"));
  table.push_back(cycles<InstructionClass::reduce>(
      10, Confidence::assumed, "test of all PEs that the control unit waits for (any, all, count)"));
  table.push_back(cycles<InstructionClass::mono>(
      1, Confidence::assumed, "instruction of the control unit: in order, 1 a cycle [reference, section 1]"));
}

void declare_control(Parameters& table) {
  constexpr auto group = &ChipConfig::control;
  constexpr Confidence assumed = Confidence::assumed;
  using Control = ChipConfig::Control;
  table.push_back(integer<group, &Control::data_cache_bytes>(
      "control.data_cache_bytes", "bytes", 4096, {64, 1048576, 8}, assumed,
      "data cache of the control unit: exists [S9], size assumed [reference, section 9]"));
  table.push_back(
      integer<group, &Control::cache_line_bytes>("control.cache_line_bytes", "bytes", 32, {8, 512, 8},
                                                 assumed, "line of the data cache [reference, section 1]"));
  table.push_back(integer<group, &Control::cache_miss_cycles>(
      "control.cache_miss_cycles", "cycles", 25, {0, kMaxCycles}, assumed,
      "cost of a miss in the control unit, on top of what the memory takes [reference, section 1]"));
  table.push_back(integer<group, &Control::semaphore_cycles>(
      "control.semaphore_cycles", "cycles", 4, {0, kMaxCycles}, assumed,
      "signal, or wait that does not block; taken as a taken branch [reference, section 1]"));
  table.push_back(integer<group, &Control::transfer_call_cycles>(
      "control.transfer_call_cycles", "cycles", 20, {0, kMaxCycles}, assumed,
      "software that starts an asynchronous copy, before the engine sees it; that send and receive overhead "
      "limits "
      "small transfers is measured [S13], the cycles are not"));
  table.push_back(integer<group, &Control::threads>("control.threads", "threads", 8, {1, 8}, assumed,
                                                    "hardware threads, the firmware's first one included: "
                                                    "exist [S15c], number assumed [reference, section 1]"));
  table.push_back(integer<group, &Control::thread_switch_cycles>(
      "control.thread_switch_cycles", "cycles", 0, {0, kMaxCycles}, assumed,
      "switch to another thread: when one waits, or a higher priority is ready [reference, section 1]"));
}

void declare_pio(Parameters& table) {
  constexpr auto group = &ChipConfig::pio;
  constexpr Confidence assumed = Confidence::assumed;
  using Pio = ChipConfig::Pio;
  table.push_back(
      {"pio.arbitration", "-",
       std::string(kPioArbitrationNames[std::size_t(PioArbitration::reads_overtake_writes)]),
       Choice(kPioArbitrationNames.begin(), kPioArbitrationNames.end()), Confidence::inferred,
       "order of service; with a strict FIFO the saves-only row of the tables would gain nothing [paper] "
       "[reference, section 6.2]",
       &Field<group, &Pio::arbitration>::read, &Field<group, &Pio::arbitration>::write});
  table.push_back(
      integer<group, &Pio::queue_depth>("pio.queue_depth", "requests", 8, {1, 1024}, assumed,
                                        "requests waiting for the one engine [reference, section 9]"));
  table.push_back(
      integer<group, &Pio::setup_cycles>("pio.setup_cycles", "cycles/request", 150, {0, kMaxCycles}, assumed,
                                         "cost of a request before its first PE; sweep 50 to 500"));
  table.push_back(integer<group, &Pio::per_pe_cycles>(
      "pio.per_pe_cycles", "cycles/PE", 16, {0, kMaxCycles}, assumed,
      "cost of a participating PE beside its bytes; that PEs count is measured [S13], sweep 4 to 60"));
  table.push_back(integer<group, &Pio::bytes_per_cycle>("pio.bytes_per_cycle", "bytes/cycle", 8, {1, 4096},
                                                        assumed,
                                                        "into or out of one PE [reference, section 9]"));
  table.push_back(integer<group, &Pio::misalignment_cycles>(
      "pio.misalignment_cycles", "cycles/PE", 8, {0, kMaxCycles}, assumed,
      "extra for a PE whose mono address is not 8-byte aligned or whose piece lies in more packets than its "
      "size needs; effect measured [S13]"));
  table.push_back(
      {"pio.consolidate_equal_addresses", "-", false, TrueOrFalse{}, assumed,
       "PEs that ask for the same address are served by one access; patent [S15g], not known of the silicon",
       &Field<group, &Pio::consolidate_equal_addresses>::read,
       &Field<group, &Pio::consolidate_equal_addresses>::write});
  table.push_back(integer<group, &Pio::stolen_sram_cycles>(
      "pio.stolen_sram_cycles", "cycles", 1, {0, 1000}, assumed,
      "cycles of the SRAM port that 8 transferred bytes take from the kernel [reference, section 2]"));
  table.push_back(integer<group, &Pio::outstanding_packets>(
      "pio.outstanding_packets", "packets", 32, {1, 1024}, assumed,
      "on the way to mono memory at a time: accesses carry transaction ids [S15g], how many is not known; "
      "felt by approximately timed runs only"));
}

void declare_clear_connect(Parameters& table) {
  constexpr auto group = &ChipConfig::clear_connect;
  constexpr Confidence assumed = Confidence::assumed;
  using ClearConnect = ChipConfig::ClearConnect;
  table.push_back(integer<group, &ClearConnect::bytes_per_cycle>(
      "clear_connect.bytes_per_cycle", "bytes/cycle", 8, {1, 4096}, assumed,
      "of a node of the on-chip network, each way [reference, section 9]"));
  table.push_back(integer<group, &ClearConnect::packet_bytes>(
      "clear_connect.packet_bytes", "bytes", 64, {8, 65536, 8}, assumed,
      "payload of a packet: that accesses are packetised is stated by the vendor [S1], the size is not"));
  table.push_back(integer<group, &ClearConnect::hop_cycles>("clear_connect.hop_cycles", "cycles", 4,
                                                            {0, 10000}, assumed,
                                                            "from node to node [reference, section 9]"));
  table.push_back(integer<group, &ClearConnect::hops_to_ddr>(
      "clear_connect.hops_to_ddr", "hops", 2, {0, 64}, assumed,
      "from PIO engine, caches or host link to the DDR port of the one-dimensional network [S13b]"));
  table.push_back(integer<group, &ClearConnect::ddr_port_bytes_per_cycle>(
      "clear_connect.ddr_port_bytes_per_cycle", "bytes/cycle", 0, {0, 4096}, assumed,
      "of the network's port to the DDR, each way [reference, section 1]; 0: as ddr.bytes_per_cycle"));
}

void declare_ddr_geometry(Parameters& table) {
  constexpr auto group = &ChipConfig::ddr;
  using Ddr = ChipConfig::Ddr;
  table.push_back(integer<group, &Ddr::size_bytes>(
      "ddr.size_bytes", "bytes", std::int64_t{512} << 20, {1 << 20, std::int64_t{64} << 30, 8},
      Confidence::stated, "mono memory of a chip: 1 GB a board of two chips [S7, S8]"));
  table.push_back(integer<group, &Ddr::banks>("ddr.banks", "banks", 4, {1, 256}, Confidence::assumed,
                                              "each with one open page [reference, section 2]"));
  table.push_back(integer<group, &Ddr::page_bytes>("ddr.page_bytes", "bytes", 512, {64, 1048576, 8},
                                                   Confidence::assumed,
                                                   "page of a bank [reference, section 2]"));
  table.push_back(integer<group, &Ddr::bytes_per_cycle>(
      "ddr.bytes_per_cycle", "bytes/cycle", 16, {1, 4096}, Confidence::inferred,
      "64-bit port [S1], 2 words a cycle, clocked with the chip [S7]: 3.36 GB/s at 210 MHz, quoted as 3.2 "
      "GB/s [S5]"));
}

void declare_ddr_timing(Parameters& table) {
  constexpr auto group = &ChipConfig::ddr;
  constexpr Confidence assumed = Confidence::assumed;
  using Ddr = ChipConfig::Ddr;
  table.push_back(integer<group, &Ddr::page_hit_cycles>(
      "ddr.page_hit_cycles", "cycles", 40, {0, kMaxCycles}, assumed,
      "latency in an open page, sweep 20 to 120 [reference, section 9]"));
  table.push_back(integer<group, &Ddr::page_miss_cycles>(
      "ddr.page_miss_cycles", "cycles", 60, {0, kMaxCycles}, assumed,
      "latency when the page must be opened first, sweep 20 to 120 [reference, section 9]"));
  table.push_back(
      integer<group, &Ddr::turn_round_cycles>("ddr.turn_round_cycles", "cycles", 4, {0, kMaxCycles}, assumed,
                                              "between a read and a write or a write and a read"));
  table.push_back(integer<group, &Ddr::refresh_interval_cycles>(
      "ddr.refresh_interval_cycles", "cycles", 1638, {0, 1'000'000'000}, Confidence::inferred,
      "from refresh to refresh: 7.8 us at 210 MHz, average of DDR2 [JESD79-2]; 0: none"));
  table.push_back(integer<group, &Ddr::refresh_cycles>(
      "ddr.refresh_cycles", "cycles", 23, {0, kMaxCycles}, Confidence::inferred,
      "a refresh: 105 ns at 210 MHz, rounded up, tRFC of 512 Mbit devices [JESD79-2], device size assumed"));
  table.push_back(integer<group, &Ddr::ecc_cycles>(
      "ddr.ecc_cycles", "cycles", 0, {0, kMaxCycles}, assumed,
      "added to each access; 72-bit modules carry ECC beside the data [S1], so none is assumed"));
  table.push_back(integer<group, &Ddr::queue_transactions>(
      "ddr.queue_transactions", "transactions", 16, {1, 1024}, assumed,
      "that the memory controller takes at a time, enough to hide a page hit; felt by approximately timed "
      "runs only"));
  table.push_back(
      {"ddr.ecc", "-", true, TrueOrFalse{}, Confidence::vendor,
       "8 more bits for each 64, of 72-bit modules [S1], correct one wrong bit and detect two; felt "
       "by faults only",
       &Field<group, &Ddr::ecc>::read, &Field<group, &Ddr::ecc>::write});
}

void declare_on_chip_sram(Parameters& table) {
  constexpr auto group = &ChipConfig::on_chip_sram;
  constexpr Confidence assumed = Confidence::assumed;
  using OnChipSram = ChipConfig::OnChipSram;
  table.push_back(seen_by_firmware(integer<group, &OnChipSram::size_bytes>(
      "on_chip_sram.size_bytes", "bytes", 131072, {0, std::int64_t{1} << 30, 1024}, Confidence::inferred,
      "memory on the chip beside the PEs' own: 1.44 MB a board of two chips [S8] less 2 x 96 x 6 KiB; 0: "
      "none")));
  table.push_back(seen_by_firmware(integer<group, &OnChipSram::first_address>(
      "on_chip_sram.first_address", "address", std::int64_t{1} << 40,
      {0, std::int64_t{1} << 60, std::int64_t{1} << 16}, assumed,
      "mono address of its first byte: above all DDR, with a hole between")));
  table.push_back(integer<group, &OnChipSram::bytes_per_cycle>(
      "on_chip_sram.bytes_per_cycle", "bytes/cycle", 16, {1, 4096}, assumed,
      "read or written at its one port, taken as wide as the port to the DDR"));
  table.push_back(integer<group, &OnChipSram::latency_cycles>(
      "on_chip_sram.latency_cycles", "cycles", 4, {0, kMaxCycles}, assumed,
      "from a request's arrival to its first byte, pipelined; a few clocks of a large SRAM at 210 MHz"));
  table.push_back(integer<group, &OnChipSram::hops>(
      "on_chip_sram.hops", "hops", 2, {0, 64}, assumed,
      "from PIO engine, caches or host link to its port, as clear_connect.hops_to_ddr"));
}

void declare_board(Parameters& table) {
  constexpr auto group = &ChipConfig::board;
  constexpr Confidence assumed = Confidence::assumed;
  using Board = ChipConfig::Board;
  table.push_back(seen_by_firmware(integer<group, &Board::chips>(
      "board.chips", "chips", 1, {1, 4, 1, true}, Confidence::stated,
      "chips in a row behind one host link, each with a DDR; X620 and e620 have two [S5], the paper does not "
      "say whether both worked")));
  table.push_back(integer<group, &Board::bridge_bytes_per_cycle>(
      "board.bridge_bytes_per_cycle", "bytes/cycle", 8, {1, 4096}, assumed,
      "of the bridge between two chips, each way: bridge ports link chips [S1], their width is not public"));
  table.push_back(
      real<group, &Board::bridge_clock_hz>("board.bridge_clock_hz", "Hz", 210e6, {1e6, 1e10}, assumed,
                                           "clock of the bridges, taken as the chip's: not public"));
  table.push_back(integer<group, &Board::bridge_latency_cycles>(
      "board.bridge_latency_cycles", "cycles", 20, {0, 1'000'000}, assumed,
      "of the bridge's clock, from chip to chip: not public; taken as five hops of the network"));
}

void declare_host(Parameters& table) {
  constexpr auto group = &ChipConfig::host;
  using Host = ChipConfig::Host;
  table.push_back(real<group, &Host::bytes_per_second>("host.bytes_per_second", "bytes/s", 800e6, {1e3, 1e12},
                                                       Confidence::stated,
                                                       "host link: X620, PCI-X through a bridge [S8]"));
  table.push_back(integer<group, &Host::latency_cycles>("host.latency_cycles", "cycles", 2100,
                                                        {0, 1'000'000'000}, Confidence::assumed,
                                                        "of one host DMA: 10 us at 210 MHz"));
}

Parameters declare_parameters() {
  Parameters table;
  declare_chip(table);
  declare_poly(table);
  declare_floating_point_cycles(table);
  declare_vector_cycles(table);
  declare_integer_cycles(table);
  declare_array_cycles(table);
  declare_control(table);
  declare_pio(table);
  declare_clear_connect(table);
  declare_ddr_geometry(table);
  declare_ddr_timing(table);
  declare_on_chip_sram(table);
  declare_search_unit(table);
  declare_board(table);
  declare_host(table);
  declare_energy(table);
  declare_area(table);
  return table;
}

}  // namespace

const std::vector<ParameterInfo>& parameter_table() {
  static const Parameters table = declare_parameters();
  return table;
}

const std::vector<ParameterSource>& parameter_sources() {
  static const std::vector<ParameterSource> sources = {
      {"reference",
       "docs/csx600.md, the project's collection of public facts; defaults where nothing is public"},
      {"paper", "Coulthurst et al., Parallel Path Tracing using Incoherent Path-Atom Binning"},
      {"S1", "ClearSpeed: Technology, http://www.clearspeed.com/acceleration/technology/"},
      {"S3", "ClearSpeed SDK Reference Manual 3.1, 06-RM-1600 rev 2.B, p. 163"},
      {"S5", "ClearSpeed CSX620 Overview, Kent State University, from vendor training slides, Dec 2007"},
      {"S7", "ClearSpeed, English Wikipedia, text of 2007"},
      {"S8",
       "B. Broadley, Beowulf mailing list, 15 Mar 2006, quoting the Intel MKL / ClearSpeed white paper"},
      {"S9", "heise, Fall Processor Forum 2004"},
      {"S10", "Ars Technica, Oct 2004"},
      {"S11", "heise, ISC'08, CSX700"},
      {"S13", "Nishikawa et al., Performance Analysis of ClearSpeed's CSX600 Interconnects, ISPA 2009"},
      {"S13b", "Nishikawa et al., analytical network performance model of the CSX600, JSA 57(1), 2011"},
      {"S15c", "US patent 7,966,475, threads and their scheduler"},
      {"S15e", "US patent 7,802,079, scoreboard and enable stack"},
      {"S15g", "US patent 7,363,472, access indicators"},
      {"RPU",
       "S. Woop, J. Schmittler, P. Slusallek, RPU: A Programmable Ray Processing Unit for Realtime Ray "
       "Tracing, SIGGRAPH 2005"},
      {"Aladdin",
       "Y. S. Shao et al., Aladdin, ISCA 2014: functional units of its file power_func.h, 40 nm, 2 ns a "
       "cycle"},
      {"CACTI",
       "CACTI 7.0 (HewlettPackard/cacti), SRAM macros, ITRS high performance, 22 to 130 nm, run by us"},
      {"Stillmaker",
       "A. Stillmaker, B. Baas, Scaling Equations for the Accurate Prediction of CMOS Device Performance "
       "from "
       "180 nm to 7 nm, Integration 58, 2017"},
      {"JESD79-2", "JEDEC, DDR2 SDRAM Specification"},
      {"Horowitz",
       "M. Horowitz, Computing's Energy Problem (and what we can do about it), ISSCC 2014: 45 nm, 0.9 V"},
      {"MT9HTF", "Micron, MT9HTF3272A/6472A/12872A DDR2 modules of nine devices, IDD at DDR2-400"}};
  return sources;
}

}  // namespace model
