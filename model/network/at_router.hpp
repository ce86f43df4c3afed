#pragma once

#include <functional>
#include <memory>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/config/address_map.hpp"
#include "model/network/clear_connect_timing.hpp"
#include "model/time/event_queue.hpp"
#include "model/transaction/at_initiator.hpp"
#include "model/transaction/at_target.hpp"

namespace model {

/// Passes packets across ClearConnect approximately timed. Their times are ClearConnectTiming's, asked in the
/// cycle in which each packet enters a link, so that initiators contend packet by packet:
/// - A request ends (END_REQ) when the initiator's link is free again.
/// - It goes to the memory whose range holds all its bytes; if there is none, its response is an address
/// error.
/// - It reaches the memory when the port has let it through, or when the memory has ended the request before.
/// - Read data occupy the port when the memory begins its response. It ends (END_RESP) when the port is
///   free again; the initiator's response begins when the last byte is there. A write's response says that
///   the memory has the last byte; nothing crosses the network for it.
///
/// Packets that wait for a memory form one queue, as long as what the initiators have on the way at most.
class AtRouter {
 public:
  using Backward = std::function<tlm::tlm_sync_enum(int initiator, tlm::tlm_generic_payload&, tlm::tlm_phase&,
                                                    sc_core::sc_time&)>;

  AtRouter(EventQueue& event_queue, ClearConnectTiming& timing, const AddressMap& map, Backward backward);

  /// Add the next initiator, or the memory of the next port, before the simulation starts.
  void add_initiator();
  void add_memory(tlm::tlm_initiator_socket<>& socket);

  tlm::tlm_sync_enum nb_transport_fw(int initiator, tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return initiators_[std::size_t(initiator)]->nb_transport_fw(packet, phase, delay);
  }
  tlm::tlm_sync_enum nb_transport_bw(Port port, tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return memories_[std::size_t(port)]->nb_transport_bw(packet, phase, delay);
  }

 private:
  /// Sticky extension: where a packet comes from and how far it has come.
  struct Route : tlm::tlm_extension<Route> {
    Initiator initiator = Initiator::pio;
    Port port = Port::ddr;
    Cycles at_memory = 0;   ///< when its first byte is at the memory
    Cycles sent_whole = 0;  ///< when its last byte is at the memory
    tlm::tlm_extension_base* clone() const override { return new Route(*this); }
    void copy_from(const tlm::tlm_extension_base& other) override {
      *this = static_cast<const Route&>(other);
    }
  };

  static Route& route_of(tlm::tlm_generic_payload& packet);
  void respond(tlm::tlm_generic_payload& packet) {
    initiators_[std::size_t(route_of(packet).initiator)]->respond(packet);
  }
  Cycles pass_request(Initiator initiator, tlm::tlm_generic_payload& packet);
  Cycles pass_response(tlm::tlm_generic_payload& packet);

  EventQueue& event_queue_;
  ClearConnectTiming& timing_;
  const AddressMap& map_;
  Backward backward_;
  std::vector<std::unique_ptr<AtInitiator>> memories_;  ///< by Port
  std::vector<std::unique_ptr<AtTarget>> initiators_;   ///< by Initiator
};

}  // namespace model
