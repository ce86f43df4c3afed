#pragma once

#include <functional>
#include <optional>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/time/event_queue.hpp"

namespace model {

/// The target's side of the base protocol on one socket (IEEE 1666-2011, 15.2): holds a reference to each
/// payload from its request to the end of its response, ends requests when its owner can take another, and
/// sends responses one after the other, each when the initiator has ended the one before.
class AtTarget {
 public:
  struct Owner {
    /// A request has begun in this cycle. Returns when it ends (END_REQ), before which the initiator cannot
    /// begin another; std::nullopt if the owner will call accept().
    std::function<std::optional<Cycles>(tlm::tlm_generic_payload&)> requested;
    /// Sends a phase back to the initiator through the socket.
    std::function<tlm::tlm_sync_enum(tlm::tlm_generic_payload&, tlm::tlm_phase&, sc_core::sc_time&)> backward;
  };

  AtTarget(EventQueue& event_queue, Owner owner) : event_queue_(event_queue), owner_(std::move(owner)) {}
  AtTarget(const AtTarget&) = delete;
  AtTarget& operator=(const AtTarget&) = delete;

  /// Ends the request, which was not ended when it began.
  void accept(tlm::tlm_generic_payload& payload);
  /// Begins the response, or does so when the one before is over. To be called from the event queue, not from
  /// within a call of the initiator.
  void respond(tlm::tlm_generic_payload& payload);

  /// To be called by the module's socket.
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

 private:
  void take_delayed_request(tlm::tlm_generic_payload& payload);
  void begin_response();
  void end_response();

  EventQueue& event_queue_;
  Owner owner_;
  std::vector<tlm::tlm_generic_payload*> responses_;  ///< not ended; the first may have begun
  bool responding_ = false;
};

}  // namespace model
