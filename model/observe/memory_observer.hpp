#pragma once

#include <cstdint>

#include "model/time/cycles.hpp"

namespace model {

/// Commands that a bank of the DDR gets.
enum class DdrCommand : std::uint8_t { activate, read, write, refresh };

/// Told what the DDR does when it is booked, which may be ahead of SystemC time: in the order of time on the
/// data bus and at each bank.
class DdrObserver {
 public:
  virtual ~DdrObserver() = default;
  /// An access, which may touch many pages, has the data bus from its first byte to after its last.
  virtual void accessed(bool write, Cycles start, Cycles finish) = 0;

  // Only reported to observers that ask for commands:
  /// Data of one page on the bus.
  virtual void moved_data(bool /*write*/, Cycles /*start*/, Cycles /*finish*/) {}
  /// Activation includes precharge. All banks are refreshed together: bank -1.
  virtual void commanded(int /*bank*/, DdrCommand /*command*/, std::uint64_t /*row*/, Cycles /*at*/) {}
};

/// Told what the on-chip SRAM does when it is booked, which may be ahead of SystemC time: in the order of
/// time at its port.
class OnChipSramObserver {
 public:
  virtual ~OnChipSramObserver() = default;
  /// An access has the port from its first byte to after its last.
  virtual void sram_accessed(bool write, Cycles start, Cycles finish) = 0;
};

enum class Initiator : std::uint8_t;

/// Told who uses the DDR's port of the on-chip network, in the order of time for each direction.
class PortObserver {
 public:
  virtual ~PortObserver() = default;
  virtual void passed(Initiator initiator, bool to_ddr, Cycles start, Cycles finish) = 0;
};

/// Told of transfers between host and mono memory.
class HostObserver {
 public:
  virtual ~HostObserver() = default;
  virtual void began_transfer(bool upload, std::uint64_t bytes, Cycles start) = 0;
  virtual void ended_transfer(bool upload, std::uint64_t bytes, Cycles start, Cycles finish) = 0;
};

}  // namespace model
