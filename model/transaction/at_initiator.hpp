#pragma once

#include <functional>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/time/event_queue.hpp"

namespace model {

/// The initiator's side of the base protocol on one socket (IEEE 1666-2011, 15.2): sends requests one after
/// the other, each when the target has ended the one before (END_REQ, or BEGIN_RESP that implies it), and
/// ends responses. Any number of transactions may be between request and response; its owner bounds them.
class AtInitiator {
 public:
  struct Owner {
    /// BEGIN_REQ of a payload that had to wait has gone out in this cycle.
    std::function<void(tlm::tlm_generic_payload&)> sent;
    /// BEGIN_RESP has come. Returns the cycle at which the response is over: this one, or a later one while
    /// the owner is busy (the target cannot begin another response before). The owner may release the
    /// payload.
    std::function<Cycles(tlm::tlm_generic_payload&)> responded;
  };

  AtInitiator(EventQueue& event_queue, tlm::tlm_initiator_socket<>& socket, Owner owner)
      : event_queue_(event_queue), socket_(socket), owner_(std::move(owner)) {}
  AtInitiator(const AtInitiator&) = delete;
  AtInitiator& operator=(const AtInitiator&) = delete;

  /// Sends a payload, which has a memory manager and which the owner keeps alive until its response. Returns
  /// whether BEGIN_REQ has gone out; else it goes out when the request before has ended.
  bool send(tlm::tlm_generic_payload& payload);
  /// Requests that wait for the one before.
  std::size_t waiting() const { return waiting_.size(); }

  /// To be called by the module's socket.
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

 private:
  void send_next();
  void begin_request(tlm::tlm_generic_payload& payload);
  void end_request();
  /// Returns when the response is over.
  Cycles take_response(tlm::tlm_generic_payload& payload);
  void take_delayed_response(tlm::tlm_generic_payload& payload);
  void end_response(tlm::tlm_generic_payload& payload);

  EventQueue& event_queue_;
  tlm::tlm_initiator_socket<>& socket_;
  Owner owner_;
  std::vector<tlm::tlm_generic_payload*> waiting_;
  tlm::tlm_generic_payload* in_request_ = nullptr;
  bool send_asked_ = false;
  bool in_call_of_target_ = false;
};

}  // namespace model
