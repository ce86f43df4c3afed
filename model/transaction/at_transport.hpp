#pragma once

#include <systemc>
#include <tlm>

#include "model/time/event_queue.hpp"
#include "model/transaction/at_initiator.hpp"

namespace model {

/// A b_transport in four phases, for the process that runs firmware: one transaction at a time, and the
/// process waits until it is over.
class AtTransport {
 public:
  AtTransport(EventQueue& event_queue, tlm::tlm_initiator_socket<>& socket)
      : event_queue_(event_queue),
        initiator_(event_queue, socket,
                   {[](auto&) {},
                    [this](auto&) {
                      over_.notify(sc_core::SC_ZERO_TIME);
                      return event_queue_.now();
                    }}) {}

  /// Sends `payload`, which nobody else may use meanwhile. Returns when it is over.
  Cycles transport(tlm::tlm_generic_payload& payload) {
    payload.set_mm(&keeper_);
    payload.acquire();
    initiator_.send(payload);
    event_queue_.pass_time_until(over_);
    payload.release();
    return event_queue_.now();
  }

  /// To be called by the module's socket.
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return initiator_.nb_transport_bw(payload, phase, delay);
  }

 private:
  /// A memory manager that frees no payload: its owner keeps it.
  struct Keeper : tlm::tlm_mm_interface {
    void free(tlm::tlm_generic_payload*) override {}
  };

  EventQueue& event_queue_;
  AtInitiator initiator_;
  Keeper keeper_;
  sc_core::sc_event over_;
};

}  // namespace model
