#pragma once

#include <cstdint>
#include <memory>
#include <systemc>
#include <tlm>
#include <vector>

#include "firmware/cn/chip/poly_memory.hpp"
#include "firmware/cn/chip/transfer.hpp"
#include "model/config/chip_config.hpp"
#include "model/control/cycle_ledger.hpp"
#include "model/control/data_cache.hpp"
#include "model/control/time_coupling.hpp"
#include "model/memory/mono_window.hpp"
#include "model/time/clock_domain.hpp"
#include "model/transaction/at_transport.hpp"

namespace model {

/// Mono memory as the control unit reads and writes it: data through a window that takes no time, time by the
/// data cache and, where that misses, by a transaction for which the control unit stands still.
class MonoAccess {
 public:
  /// @param event_queue null for a loosely timed control unit
  MonoAccess(const ChipConfig& config, const ClockDomain& clock, CycleLedger& ledger, TimeCoupling& time,
             cn::PolyMemory& poly_memory, tlm::tlm_initiator_socket<>& socket, EventQueue* event_queue);

  const void* read(cn::MonoAddress from, std::size_t bytes);
  /// Write-through, and the control unit waits until the memory has it: what it tells the host must be there
  /// before the signal is.
  void write(cn::MonoAddress to, const void* bytes, std::size_t size);

  // Outside timed code:
  const void* read_untimed(cn::MonoAddress from, std::size_t bytes);
  void write_untimed(cn::MonoAddress to, const void* bytes, std::size_t size);
  /// Throws cn::MachineFault when the transfer is not within mono memory and the PEs' SRAM.
  void move_untimed(const cn::Transfer& transfer);

  /// MonoWindow::follow().
  void follow(const AddressMap& map) { window_.follow(map); }
  void empty_cache() { cache_.clear(); }
  /// The memory takes back its direct pointer.
  void forget_pointer() { window_.invalidate(); }
  /// Passes on what the socket receives; approximately timed only.
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return at_transport_->nb_transport_bw(payload, phase, delay);
  }

 private:
  void send(tlm::tlm_command command, cn::MonoAddress address, std::uint8_t* data, std::size_t size);
  /// Sends transaction_ at the firmware's cycle; returns when it is over.
  Cycles transport();
  tlm::tlm_fw_transport_if<>& memory() { return *socket_.operator->(); }

  ClockDomain clock_;
  Cycles miss_cycles_;
  CycleLedger& ledger_;
  TimeCoupling& time_;
  tlm::tlm_initiator_socket<>& socket_;
  DataCache cache_;
  MonoWindow window_;
  std::unique_ptr<AtTransport> at_transport_;  ///< null when loosely timed
  tlm::tlm_generic_payload transaction_;
  std::vector<std::uint8_t> line_;
};

}  // namespace model
