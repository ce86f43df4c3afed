#include <array>

#include "model/config/parameter_declaration.hpp"

// First-order energy. On-chip entries are those of a 45 nm process at 0.9 V, where figures are public
// [Horowitz]; energy.chip_scale turns them into the CSX600's. A PE's instruction is 6 pJ of register file and
// what its unit takes:
//
//   fp32 add 0.9, multiply 3.7; fp64 add 1.8 (twice the width), multiply 18 ((53 / 24)^2 of fp32's)
//   int16 pass 0.05, int16 multiply 0.8 (a quarter of int32's 3.1)
//   routines: cycles / 4 passes, half of them adds, half multiplies
//   SRAM: 5 a 4-byte word, half of a 64-bit word of an 8 KB cache

namespace model {
namespace {

using cn::InstructionClass;
using Energy = ChipConfig::Energy;
constexpr auto kGroup = &ChipConfig::energy;
constexpr RealRange kAnyEnergy = {0, 1e12};

template <auto member>
void declare(std::vector<ParameterInfo>& table, const char* key, const char* unit, double default_value,
             Confidence confidence, const char* meaning) {
  table.push_back(real<kGroup, member>(key, unit, default_value, kAnyEnergy, confidence, meaning));
}

template <InstructionClass c>
void instruction(std::vector<ParameterInfo>& table, double picojoules, const char* meaning,
                 Confidence confidence = Confidence::inferred) {
  constexpr std::size_t kIndex = static_cast<std::size_t>(c);
  constexpr bool kIsWord = c == InstructionClass::sram || c == InstructionClass::sram_vector_load;
  table.push_back({"energy.picojoules." + std::string(cn::kInstructionClassNames[kIndex]),
                   kIsWord ? "pJ/word" : "pJ", picojoules, kAnyEnergy, confidence, meaning,
                   [](const ChipConfig& config) { return to_value(config.energy.picojoules[kIndex]); },
                   [](ChipConfig& config, const ParameterValue& value) {
                     from_value(value, config.energy.picojoules[kIndex]);
                   }});
}

void declare_arithmetic(std::vector<ParameterInfo>& table) {
  constexpr const char* kRoutine = "routine: cycles / 4 passes of adder and multiplier in turn [Horowitz]";
  instruction<InstructionClass::fp64_add>(table, 7.8, "register file 6, adder 2 x 0.9 [Horowitz]");
  instruction<InstructionClass::fp64_mul>(table, 24,
                                          "register file 6, multiplier 3.7 x (53 / 24)^2 [Horowitz]");
  instruction<InstructionClass::fp64_div>(table, 159, kRoutine);
  instruction<InstructionClass::fp64_sqrt>(table, 199, kRoutine);
  instruction<InstructionClass::fp64_sincos>(table, 437, kRoutine);
  instruction<InstructionClass::fp64_exp>(table, 358, kRoutine);
  instruction<InstructionClass::fp64_log>(table, 358, kRoutine);
  instruction<InstructionClass::fp64_atan2>(table, 437, kRoutine);
  instruction<InstructionClass::fp32_add>(table, 6.9, "register file 6, adder 0.9 [Horowitz]");
  instruction<InstructionClass::fp32_mul>(table, 9.7, "register file 6, multiplier 3.7 [Horowitz]");
  instruction<InstructionClass::fp32_div>(table, 50, kRoutine);
  instruction<InstructionClass::fp32_sqrt>(table, 58, kRoutine);
  instruction<InstructionClass::fp64_add_vector4>(table, 31.2, "4 x fp64_add [Horowitz]");
  instruction<InstructionClass::fp64_mul_vector4>(table, 96, "4 x fp64_mul [Horowitz]");
  instruction<InstructionClass::fp64_multiply_add_vector4>(
      table, 103.2, "4 x (register file 6, multiplier 18, adder 1.8) [Horowitz]");
  instruction<InstructionClass::fp32_add_vector4>(table, 27.6, "4 x fp32_add [Horowitz]");
  instruction<InstructionClass::fp32_mul_vector4>(table, 38.8, "4 x fp32_mul [Horowitz]");
  instruction<InstructionClass::fp32_multiply_add_vector4>(
      table, 42.4, "4 x (register file 6, multiplier 3.7, adder 0.9) [Horowitz]");
}

void declare_other_instructions(std::vector<ParameterInfo>& table) {
  constexpr Confidence assumed = Confidence::assumed;
  instruction<InstructionClass::int16_alu>(table, 6.05, "register file 6, a pass of the ALU 0.05 [Horowitz]");
  instruction<InstructionClass::int32_alu>(table, 12.1, "2 passes of int16_alu [Horowitz]");
  instruction<InstructionClass::int64_alu>(table, 24.2, "4 passes of int16_alu [Horowitz]");
  instruction<InstructionClass::int16_mul>(table, 6.8, "register file 6, a quarter of 3.1 [Horowitz]");
  instruction<InstructionClass::int32_mul>(table, 27.2, "4 of int16_mul [Horowitz]");
  instruction<InstructionClass::int64_mul>(table, 108.8, "4 of int32_mul [Horowitz]");
  instruction<InstructionClass::move>(table, 12, "register file twice, 4 bytes each [Horowitz]");
  instruction<InstructionClass::convert>(table, 7.8, "taken as fp64_add [Horowitz]");
  instruction<InstructionClass::enable>(table, 1, "one bit of state, set in each PE", assumed);
  instruction<InstructionClass::sram>(table, 5,
                                      "half of a 64-bit word of an 8 KB cache [Horowitz]; of 6 "
                                      "KiB, other sizes by the square root [CACTI]");
  instruction<InstructionClass::sram_vector_load>(table, 5, "as sram [Horowitz]");
  instruction<InstructionClass::swazzle>(table, 13, "two register files and a short wire", assumed);
  instruction<InstructionClass::swazzle_vector4>(table, 52, "4 x swazzle", assumed);
  instruction<InstructionClass::reduce>(table, 7, "register file and a wire across the array", assumed);
}

void declare_rest_of_chip(std::vector<ParameterInfo>& table) {
  constexpr Confidence assumed = Confidence::assumed;
  declare<&Energy::pe_clock_picojoules>(table, "energy.pe_clock_picojoules", "pJ/PE/cycle", 10, assumed,
                                        "clock and pipeline registers of a PE, enabled or not; a third of "
                                        "the chip's 10 W, which is usual for a "
                                        "clock");
  declare<&Energy::control_unit_picojoules>(
      table, "energy.control_unit_picojoules", "pJ/cycle", 70, Confidence::inferred,
      "a cycle in which the control unit does not wait: an instruction of a simple core [Horowitz]");
  declare<&Energy::pio_picojoules_per_byte>(
      table, "energy.pio_picojoules_per_byte", "pJ/byte", 5, assumed,
      "moved by the PIO engine across the array, beside the SRAM word at its end");
  declare<&Energy::clear_connect_picojoules>(table, "energy.clear_connect_picojoules", "pJ/byte/hop", 2,
                                             assumed, "a byte from node to node of the on-chip network");
  declare<&Energy::on_chip_sram_picojoules_per_byte>(
      table, "energy.on_chip_sram_picojoules_per_byte", "pJ/byte", 4.75, Confidence::inferred,
      "read from or written to an on-chip SRAM of 128 KiB, other sizes by the square root: 38 pJ for 8 "
      "bytes, "
      "between 20 of a 32 KB and 100 of a 1 MB cache [Horowitz]");
  declare<&Energy::search_box_picojoules>(
      table, "energy.search_box_picojoules", "pJ", 28, Confidence::inferred,
      "a box by a search unit: 6 fp32 additions and multiplications without register file [Horowitz]; "
      "scaled as a PE's, so rather too much; within a factor of 3");
  declare<&Energy::search_leaf_picojoules>(
      table, "energy.search_leaf_picojoules", "pJ", 351, Confidence::inferred,
      "a triangle by a search unit: 18 fp64 multiplications, 15 additions [Horowitz]; as above");
  declare<&Energy::search_line_picojoules>(
      table, "energy.search_line_picojoules", "pJ", 120, Confidence::inferred,
      "a line of 64 bytes looked up or brought: 8 words of a 16 KB cache, 15 each, between 10 of 8 KB and 20 "
      "of 32 KB [Horowitz]");
  declare<&Energy::search_picojoules_per_byte>(
      table, "energy.search_picojoules_per_byte", "pJ/byte", 4.75, Confidence::inferred,
      "the search unit's buffer, as energy.on_chip_sram_picojoules_per_byte [Horowitz]");
  declare<&Energy::search_clock_picojoules>(
      table, "energy.search_clock_picojoules", "pJ/cycle", 100, assumed,
      "clock of a search unit: that of ten PEs, whose area it has; 30 to 300");
  declare<&Energy::search_leakage_watts>(table, "energy.search_leakage_watts", "W", 0.08, assumed,
                                         "of a search unit, as ten PEs");
  declare<&Energy::leakage_watts_per_pe>(
      table, "energy.leakage_watts_per_pe", "W/PE", 0.008, assumed,
      "of a PE with 6 KiB; with the rest of the chip 1 W, a tenth of its power, as leakage was at 0.13 um");
  declare<&Energy::leakage_watts>(
      table, "energy.leakage_watts", "W", 0.232, assumed,
      "of the chip without its PEs, with 128 KiB of on_chip_sram, see energy.leakage_watts_per_pe");
  declare<&Energy::sram_leakage_watts_per_kib>(
      table, "energy.sram_leakage_watts_per_kib", "W/KiB", 0.00027, Confidence::inferred,
      "of SRAM beyond 6 KiB a PE and 128 KiB of on_chip_sram, which the other leakages cover: 1.62 mW for 6 "
      "KiB, 8.2 for 32, 30 for 128 [CACTI]; high-performance cells, low-power ones leak a hundredth");
}

void declare_technology(std::vector<ParameterInfo>& table) {
  constexpr auto group = &ChipConfig::technology;
  using Technology = ChipConfig::Technology;
  table.push_back(integer<group, &Technology::node_nm>(
      "technology.node_nm", "nm", 130, {7, 130}, Confidence::inferred,
      "process: that of the predecessor CS301 [S10], the CSX600's is not public; energy and area on the chip "
      "follow it, the clock does not [Stillmaker]"));
  // The polynomial of 65 nm is the last to stop falling, at 0.586 V.
  table.push_back(real<group, &Technology::voltage_v>(
      "technology.voltage_v", "V", 1.2, {0.6, 1.4}, Confidence::assumed,
      "supply of the chip's core: usual at 130 nm; at other nodes set it, too"));
}

void declare_ddr(std::vector<ParameterInfo>& table) {
  constexpr Confidence inferred = Confidence::inferred;
  constexpr Confidence assumed = Confidence::assumed;
  declare<&Energy::ddr_activate_picojoules>(
      table, "energy.ddr_activate_picojoules", "pJ", 40000, inferred,
      "a page miss: (IDD0 675 mA - IDD3N 270 mA) x 1.8 V x 55 ns of nine devices [MT9HTF]");
  declare<&Energy::ddr_read_picojoules>(
      table, "energy.ddr_read_picojoules", "pJ/byte", 400, assumed,
      "about 0.7 A above IDD3N x 1.8 V at 3.2 GB/s, nine devices of DDR2-400");
  declare<&Energy::ddr_write_picojoules>(table, "energy.ddr_write_picojoules", "pJ/byte", 400, assumed,
                                         "as energy.ddr_read_picojoules");
  declare<&Energy::ddr_refresh_picojoules>(
      table, "energy.ddr_refresh_picojoules", "pJ", 230000, assumed,
      "a refresh: about 1.2 A above IDD3N x 1.8 V x 105 ns, nine devices of DDR2-400");
  declare<&Energy::ddr_background_watts>(table, "energy.ddr_background_watts", "W", 0.49, inferred,
                                         "IDD3N 270 mA x 1.8 V of nine devices, banks open [MT9HTF]");
}

}  // namespace

void declare_energy(std::vector<ParameterInfo>& table) {
  declare_technology(table);
  declare<&Energy::chip_scale>(
      table, "energy.chip_scale", "-", 15.93, Confidence::inferred,
      "factor for the on-chip picojoules below, which are of 45 nm and 0.9 V: fitted so that the chip takes "
      "10 "
      "W [S1] while it runs DGEMM (firmware/examples) at 210 MHz; from 45 nm to 0.13 um and 1.2 V alone make "
      "5.1, the rest is what the table leaves out");
  declare_rest_of_chip(table);
  declare_ddr(table);
  declare_arithmetic(table);  // a group of its own in TOML, so it comes last
  declare_other_instructions(table);
}

}  // namespace model
