#pragma once

#include <array>
#include <cstdint>

#include "model/time/cycles.hpp"

namespace model {

enum class FaultKind : std::uint8_t {
  poly_sram,
  poly_register,
  ddr,
  ddr_double,
  pio_lost,
  pio_late,
  pio_doubled,
  enable_off,
};

/// A fault of the hardware. Which members count is FaultKindInfo's to say.
struct Fault {
  FaultKind kind = FaultKind::poly_sram;
  Cycles cycle = 0;  ///< counted from the firmware's start
  int pe = 0;
  /// In bytes: within the PE's SRAM, or in mono memory. Of a register, the number of its value among those
  /// that the kernel stores.
  std::uint64_t address = 0;
  int bit = 0;  ///< of the byte; of a register, of its 64
  Cycles late_cycles = 0;
};

/// A kind of fault as users name it: everything that lists kinds reads this table.
struct FaultKindInfo {
  FaultKind kind;
  const char* name;
  const char* unit;
  const char* meaning;
  bool has_pe;
  bool has_address;
  int bits;  ///< how many a fault may choose from; 0: it has no bit
  bool has_late_cycles;
};

inline constexpr std::array<FaultKindInfo, 8> kFaultKinds{{
    {FaultKind::poly_sram, "poly_sram", "SRAM of the PEs", "a bit of a PE's SRAM flips", true, true, 8,
     false},
    {FaultKind::poly_register, "poly_register", "registers of the PEs",
     "a bit flips in a register whose value the kernel in progress stores", true, true, 64, false},
    {FaultKind::ddr, "ddr", "DDR", "a bit of mono memory flips", false, true, 8, false},
    {FaultKind::ddr_double, "ddr_double", "DDR", "two neighbouring bits of a byte of mono memory flip", false,
     true, 7, false},
    {FaultKind::pio_lost, "pio_lost", "PIO", "a finished request signals nobody", false, false, 0, false},
    {FaultKind::pio_late, "pio_late", "PIO", "a finished request signals late by so many cycles", false,
     false, 0, true},
    {FaultKind::pio_doubled, "pio_doubled", "PIO", "a finished request signals twice", false, false, 0,
     false},
    {FaultKind::enable_off, "enable_off", "enable bits of the PEs",
     "a PE stores nothing and takes part in no transfer from then on", true, false, 0, false},
}};

constexpr const FaultKindInfo& info_of(FaultKind kind) {
  return kFaultKinds[static_cast<std::size_t>(kind)];
}

/// What became of the faults of a run.
struct FaultCounts {
  std::uint64_t injected = 0;
  std::uint64_t corrected = 0;  ///< by the ECC of the DDR, when the word was read
  std::uint64_t detected = 0;   ///< by it, and beyond correction
};

/// How the messages of runs begin that ECC or the watchdog stopped.
inline constexpr const char* kEccMessage = "ECC: ";
inline constexpr const char* kWatchdogMessage = "watchdog: ";

}  // namespace model
