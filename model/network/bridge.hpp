#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>
#include <cstdint>
#include <optional>
#include <systemc>
#include <tlm>

#include "model/config/chip_config.hpp"
#include "model/time/clock_domain.hpp"
#include "model/time/event_queue.hpp"
#include "model/transaction/at_initiator.hpp"
#include "model/transaction/at_target.hpp"
#include "model/transaction/payload_pool.hpp"

namespace model {

struct BridgeStatistics {
  std::uint64_t bytes = 0;
  std::uint64_t transactions = 0;
  std::uint64_t waiting_cycles = 0;  ///< of the near chip: transactions waited for the one before
};

/// When bytes cross a bridge, in cycles of the near chip: a time line each way at the bridge's width and
/// clock, and a latency from chip to chip. Transactions are cut through, as on the network.
class BridgeTiming {
 public:
  struct Passage {
    Cycles first;  ///< when the first byte is across
    Cycles last;   ///< when the last byte is across
    Cycles free;   ///< when the bridge can take the next one
  };

  BridgeTiming(const ChipConfig::Board& board, double chip_clock_hz);

  /// A request without data takes one cycle of the bridge.
  Passage forward(std::uint64_t bytes, Cycles now) { return cross(forward_free_, bytes, now, now); }
  /// Read data, which the far side delivers up to `last`.
  Passage backward(std::uint64_t bytes, Cycles last);

  const BridgeStatistics& statistics() const { return statistics_; }

 private:
  Cycles data_cycles(std::uint64_t bytes) const;
  Passage cross(Cycles& free, std::uint64_t bytes, Cycles first, Cycles last);

  double chip_cycles_per_cycle_;
  double bytes_per_cycle_;  ///< of the bridge
  Cycles latency_cycles_;
  Cycles forward_free_ = 0;
  Cycles backward_free_ = 0;
  BridgeStatistics statistics_;
};

/// A bridge from the network of one chip to that of another: a memory of the near network's address map, an
/// initiator of the far network. Bridge ports link chips (docs/csx600.md, section 1); their width, clock and
/// latency are parameters of the board. Addresses are the far network's. For both ways between two chips
/// there are two bridges.
class Bridge : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<Bridge> near_socket{"near_socket"};
  tlm_utils::simple_initiator_socket<Bridge> far_socket{"far_socket"};

  /// @param chip the near chip
  /// @param event_queue of the near chip; null when loosely timed
  Bridge(const sc_core::sc_module_name& name, const ChipConfig& chip, EventQueue* event_queue = nullptr);

  const BridgeStatistics& statistics() const { return timing_.statistics(); }

 private:
  /// Sticky extension of the payload on the far side: whose request it is.
  struct Origin : tlm::tlm_extension<Origin> {
    tlm::tlm_generic_payload* payload = nullptr;
    Cycles sent_whole = 0;  ///< when its last byte is across
    tlm::tlm_extension_base* clone() const override { return new Origin(*this); }
    void copy_from(const tlm::tlm_extension_base& other) override {
      *this = static_cast<const Origin&>(other);
    }
  };

  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  unsigned int transport_dbg(tlm::tlm_generic_payload& transaction) {
    return far_socket->transport_dbg(transaction);
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi) {
    return far_socket->get_direct_mem_ptr(transaction, dmi);
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) {
    near_socket->invalidate_direct_mem_ptr(start, end);
  }

  // Approximately timed:
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& near, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return near_->nb_transport_fw(near, phase, delay);
  }
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& far, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return far_->nb_transport_bw(far, phase, delay);
  }
  Cycles pass_request(tlm::tlm_generic_payload& near);
  Cycles pass_response(tlm::tlm_generic_payload& far);

  ClockDomain clock_;
  BridgeTiming timing_;
  EventQueue* event_queue_;
  PayloadPool pool_;
  std::optional<AtTarget> near_;
  std::optional<AtInitiator> far_;
};

}  // namespace model
