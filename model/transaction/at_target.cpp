#include "model/transaction/at_target.hpp"

namespace model {

tlm::tlm_sync_enum AtTarget::nb_transport_fw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                             sc_core::sc_time& delay) {
  if (phase == tlm::END_RESP) {
    event_queue_.schedule(event_queue_.cycle_after(delay), [this] { end_response(); });
    return tlm::TLM_COMPLETED;
  }
  if (phase != tlm::BEGIN_REQ) return tlm::TLM_ACCEPTED;  // an ignorable phase
  payload.acquire();
  if (delay != sc_core::SC_ZERO_TIME) {
    event_queue_.schedule(event_queue_.cycle_after(delay),
                          [this, &payload] { take_delayed_request(payload); });
    return tlm::TLM_ACCEPTED;
  }
  const std::optional<Cycles> accepted = owner_.requested(payload);
  if (!accepted) return tlm::TLM_ACCEPTED;
  phase = tlm::END_REQ;
  delay = event_queue_.delay_until(*accepted);
  return tlm::TLM_UPDATED;
}

void AtTarget::take_delayed_request(tlm::tlm_generic_payload& payload) {
  const std::optional<Cycles> accepted = owner_.requested(payload);
  if (accepted) event_queue_.schedule(*accepted, [this, &payload] { accept(payload); });
}

void AtTarget::accept(tlm::tlm_generic_payload& payload) {
  tlm::tlm_phase phase = tlm::END_REQ;
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  owner_.backward(payload, phase, delay);
}

void AtTarget::respond(tlm::tlm_generic_payload& payload) {
  responses_.push_back(&payload);
  if (!responding_) begin_response();
}

void AtTarget::begin_response() {
  responding_ = true;
  tlm::tlm_phase phase = tlm::BEGIN_RESP;
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  if (owner_.backward(*responses_.front(), phase, delay) == tlm::TLM_ACCEPTED) return;  // END_RESP will come
  if (delay == sc_core::SC_ZERO_TIME) {
    end_response();
  } else {
    event_queue_.schedule(event_queue_.cycle_after(delay), [this] { end_response(); });
  }
}

void AtTarget::end_response() {
  tlm::tlm_generic_payload& payload = *responses_.front();
  responses_.erase(responses_.begin());
  responding_ = false;
  payload.release();
  if (!responses_.empty()) begin_response();
}

}  // namespace model
