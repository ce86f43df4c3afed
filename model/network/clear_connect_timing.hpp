#pragma once

#include <array>
#include <cstdint>

#include "model/config/chip_config.hpp"
#include "model/observe/memory_observer.hpp"
#include "model/time/cycles.hpp"
#include "model/transaction/divisor.hpp"

namespace model {

/// The units that use the on-chip network.
enum class Initiator : std::uint8_t { pio, control, host };
inline constexpr std::size_t kInitiators = 3;

struct ClearConnectStatistics {
  std::uint64_t bytes = 0;
  std::uint64_t packets = 0;
  std::uint64_t waiting_cycles = 0;  ///< packets waited for the port to the DDR
};

/// The timing of packets between an initiator and the DDR. Each initiator has a link each way at
/// `bytes_per_cycle`; all share the DDR's port, which is as wide as the DDR (docs/csx600.md, section 1: 8
/// bytes/cycle a node, 16 at the DDR port). Every link and the port, each way, is a time line (next free
/// cycle). Packets are cut through: a stage passes on the first bytes before it has the last. A
/// packet without data (a read request) takes one cycle; widths are those of the payload, so headers of data
/// packets cost nothing more.
class ClearConnectTiming {
 public:
  struct Passage {
    Cycles first;  ///< when the first packet is there
    Cycles last;   ///< when the last byte is there
    Cycles sent;   ///< when the initiator's link is free again
  };

  ClearConnectTiming(const ChipConfig::ClearConnect& config, int ddr_port_bytes_per_cycle);

  /// How many packets `bytes` of contiguous mono memory are.
  std::uint64_t packets_for(std::uint64_t bytes) const {
    return packet_bytes_.quotient(bytes + packet_bytes_.value() - 1);
  }

  /// Sends `packets` read requests towards the DDR at `now`.
  Passage request(Initiator initiator, std::uint64_t packets, Cycles now);
  /// Sends data of a write towards the DDR.
  Passage forward(Initiator initiator, std::uint64_t bytes, std::uint64_t packets, Cycles now);
  /// Sends data of a read, which the DDR delivers from `first` to `last`. Returns when the last byte is at
  /// the initiator.
  Cycles backward(Initiator initiator, std::uint64_t bytes, std::uint64_t packets, Cycles first, Cycles last);

  /// For how long `bytes` occupy the DDR's port.
  Cycles port_cycles(std::uint64_t bytes) const;
  Cycles backward_port_free() const { return backward_port_free_; }

  const ClearConnectStatistics& statistics(Initiator initiator) const {
    return statistics_[std::size_t(initiator)];
  }
  void set_observer(PortObserver* observer) { observer_ = observer; }

 private:
  Passage send(Initiator initiator, Cycles link_cycles, Cycles port_cycles, Cycles now);
  Cycles wait_for_port(Initiator initiator, Cycles& port_free, Cycles ready);

  Divisor packet_bytes_;
  Divisor link_bytes_per_cycle_;
  Divisor port_bytes_per_cycle_;
  Cycles latency_cycles_;  ///< all hops, one way

  std::array<Cycles, kInitiators> forward_link_free_{};
  std::array<Cycles, kInitiators> backward_link_free_{};
  Cycles forward_port_free_ = 0;
  Cycles backward_port_free_ = 0;
  std::array<ClearConnectStatistics, kInitiators> statistics_;
  PortObserver* observer_ = nullptr;
};

}  // namespace model
