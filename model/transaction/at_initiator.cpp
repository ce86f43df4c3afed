#include "model/transaction/at_initiator.hpp"

namespace model {

bool AtInitiator::send(tlm::tlm_generic_payload& payload) {
  if (in_request_ == nullptr && waiting_.empty() && !in_call_of_target_) {
    begin_request(payload);
    return true;
  }
  waiting_.push_back(&payload);
  send_next();
  return false;
}

/// Goes through the event queue, so that no request is sent from within a target's own call.
void AtInitiator::send_next() {
  if (send_asked_ || in_request_ != nullptr || waiting_.empty()) return;
  send_asked_ = true;
  event_queue_.schedule(event_queue_.now(), [this] {
    send_asked_ = false;
    tlm::tlm_generic_payload& next = *waiting_.front();
    waiting_.erase(waiting_.begin());
    begin_request(next);
    owner_.sent(next);
  });
}

void AtInitiator::begin_request(tlm::tlm_generic_payload& payload) {
  in_request_ = &payload;
  tlm::tlm_phase phase = tlm::BEGIN_REQ;
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  const tlm::tlm_sync_enum answer = socket_->nb_transport_fw(payload, phase, delay);
  if (answer == tlm::TLM_ACCEPTED) return;
  if (answer == tlm::TLM_UPDATED && phase == tlm::END_REQ) {
    if (delay == sc_core::SC_ZERO_TIME) {
      end_request();
    } else {
      event_queue_.schedule(event_queue_.cycle_after(delay), [this] { end_request(); });
    }
  } else if (answer == tlm::TLM_UPDATED) {
    event_queue_.schedule(event_queue_.cycle_after(delay),
                          [this, &payload] { take_delayed_response(payload); });
  } else {  // TLM_COMPLETED: the target skips all further phases
    event_queue_.schedule(event_queue_.cycle_after(delay), [this, &payload] { take_response(payload); });
  }
}

tlm::tlm_sync_enum AtInitiator::nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                                sc_core::sc_time& delay) {
  if (phase == tlm::END_REQ) {
    event_queue_.schedule(event_queue_.cycle_after(delay), [this] { end_request(); });
    return tlm::TLM_ACCEPTED;
  }
  if (phase != tlm::BEGIN_RESP) return tlm::TLM_ACCEPTED;  // an ignorable phase
  if (delay != sc_core::SC_ZERO_TIME) {
    event_queue_.schedule(event_queue_.cycle_after(delay),
                          [this, &payload] { take_delayed_response(payload); });
    return tlm::TLM_ACCEPTED;
  }
  payload.acquire();  // the owner may release it before the response is over
  in_call_of_target_ = true;
  const Cycles over = take_response(payload);
  in_call_of_target_ = false;
  if (over > event_queue_.now()) {
    event_queue_.schedule(over, [this, &payload] { end_response(payload); });
    return tlm::TLM_ACCEPTED;
  }
  payload.release();
  phase = tlm::END_RESP;
  return tlm::TLM_UPDATED;
}

void AtInitiator::end_request() {
  in_request_ = nullptr;
  send_next();
}

Cycles AtInitiator::take_response(tlm::tlm_generic_payload& payload) {
  if (in_request_ == &payload) end_request();
  return owner_.responded(payload);
}

void AtInitiator::take_delayed_response(tlm::tlm_generic_payload& payload) {
  payload.acquire();
  event_queue_.schedule(take_response(payload), [this, &payload] { end_response(payload); });
}

void AtInitiator::end_response(tlm::tlm_generic_payload& payload) {
  tlm::tlm_phase phase = tlm::END_RESP;
  sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
  socket_->nb_transport_fw(payload, phase, delay);
  payload.release();
}

}  // namespace model
