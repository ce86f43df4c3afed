#pragma once

#include <cstdint>
#include <vector>

#include "model/config/chip_config.hpp"
#include "model/observe/memory_observer.hpp"
#include "model/time/cycles.hpp"
#include "model/transaction/divisor.hpp"

namespace model {

/// The chip's own units that use the on-chip network. ClearConnect::bind_initiator() gives others further
/// numbers.
enum class Initiator : std::uint8_t { pio, control, host };
inline constexpr std::size_t kInitiators = 3;

/// Where a memory is bound to the network. The DDR's port comes first, ClearConnect::bind() adds others.
enum class Port : std::uint8_t { ddr };

struct PortConfig {
  int bytes_per_cycle;  ///< each way
  int hops;             ///< from any initiator
};

struct ClearConnectStatistics {
  std::uint64_t bytes = 0;
  std::uint64_t packets = 0;
  std::uint64_t waiting_cycles = 0;  ///< packets waited for the ports to memories
};

/// The timing of packets between initiators and memories. Each initiator has a link each way at
/// `bytes_per_cycle`; all share the port of each memory, which has a width of its own (docs/csx600.md,
/// section 1: 8 bytes/cycle a node, 16 at the DDR port). Every link and every port, each way, is a time line
/// (next free cycle), so that transfers to different memories meet at most on their initiator's link (several
/// transfers at once, docs/csx600.md, section 1). Packets are cut through: a stage passes on the first bytes
/// before it has the last. A packet without data (a read request) takes one cycle; widths are those of the
/// payload, so headers of data packets cost nothing more.
class ClearConnectTiming {
 public:
  struct Passage {
    Cycles first;  ///< when the first packet is there
    Cycles last;   ///< when the last byte is there
    Cycles sent;   ///< when the initiator's link is free again
  };

  /// With one port, Port::ddr, and the chip's own initiators.
  ClearConnectTiming(const ChipConfig::ClearConnect& config, int ddr_bytes_per_cycle);

  Port add_port(const PortConfig& port);
  Initiator add_initiator();

  /// How many packets `bytes` of contiguous mono memory are.
  std::uint64_t packets_for(std::uint64_t bytes) const {
    return packet_bytes_.quotient(bytes + packet_bytes_.value() - 1);
  }

  /// Sends `packets` read requests towards a memory at `now`.
  Passage request(Initiator initiator, std::uint64_t packets, Cycles now, Port port = Port::ddr);
  /// Sends data of a write towards a memory.
  Passage forward(Initiator initiator, std::uint64_t bytes, std::uint64_t packets, Cycles now,
                  Port port = Port::ddr);
  /// Sends data of a read, which the memory delivers from `first` to `last`. Returns when the last byte is at
  /// the initiator.
  Cycles backward(Initiator initiator, std::uint64_t bytes, std::uint64_t packets, Cycles first, Cycles last,
                  Port port = Port::ddr);

  /// For how long `bytes` occupy a port.
  Cycles port_cycles(std::uint64_t bytes, Port port = Port::ddr) const;
  Cycles backward_port_free(Port port) const { return ports_[std::size_t(port)].backward_free; }

  const ClearConnectStatistics& statistics(Initiator initiator) const {
    return links_[std::size_t(initiator)].statistics;
  }
  /// Sets who is told of the DDR's port.
  void set_observer(PortObserver* observer) { ports_.front().observer = observer; }

 private:
  struct Link {
    Cycles forward_free = 0;
    Cycles backward_free = 0;
    ClearConnectStatistics statistics;
  };
  struct PortState {
    Divisor bytes_per_cycle;
    Cycles latency_cycles;  ///< all hops, one way
    Cycles forward_free = 0;
    Cycles backward_free = 0;
    PortObserver* observer = nullptr;
  };

  Link& link(Initiator initiator) { return links_[std::size_t(initiator)]; }
  PortState& port_state(Port port) { return ports_[std::size_t(port)]; }
  Passage send(Initiator initiator, Port to, Cycles link_cycles, Cycles port_cycles, Cycles now);
  static Cycles wait_for_port(Link& link, Cycles port_free, Cycles ready);

  Divisor packet_bytes_;
  Divisor link_bytes_per_cycle_;
  int hop_cycles_;
  std::vector<Link> links_;
  std::vector<PortState> ports_;
};

}  // namespace model
