#pragma once

#include <string_view>
#include <vector>

#include "testbench/run/chip_statistics.hpp"

namespace testbench {

/// What a run attained of what the chip could (Williams, Waterman and Patterson, Roofline, CACM 52(4), 2009).
struct Roof {
  std::string_view name;
  double amount;  ///< floating-point operations or bytes
  double attained_per_second;
  double peak_per_second;

  double share() const { return peak_per_second > 0 ? attained_per_second / peak_per_second : 0; }
};

struct Roofline {
  /// pe_array, pio, clear_connect, ddr. Operations are those of enabled PEs; a routine (square root, sine,
  /// ...) is one, both precisions alike.
  std::vector<Roof> roofs;

  /// The roof of which the run attained most.
  const Roof& nearest() const;
  const Roof& roof(std::string_view name) const;
  double flops() const { return roof("pe_array").amount; }
  /// The rate of operations at which the nearest roof would stop the same program.
  double attainable_flops_per_second() const;
  /// Operations for each byte through that roof; 0 when no byte went through.
  double intensity(std::string_view name) const;
};

/// The roofline of the time from the firmware's start to its end. Peaks come from the chip's parameters:
///   pe_array       PEs x clock x most operations that any instruction class does a cycle (cost table)
///   pio            bytes a cycle of its engine, or of its two engines
///   clear_connect  bytes a cycle of a node's link, both ways
///   ddr            bytes a cycle of the data bus
/// of all arrays and chips together.
Roofline roofline_of(const ChipStatistics& statistics);

/// Floating-point operations of one instruction in one PE.
int flops_of(cn::InstructionClass instruction);
double flops_of(const cn::IssueCounts& executed);

}  // namespace testbench
