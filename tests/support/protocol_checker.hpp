#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>
#include <algorithm>
#include <map>
#include <string>
#include <systemc>
#include <tlm>
#include <vector>

namespace test_support {

/// Sits between an initiator and a target, passes everything on and records violations of the base protocol
/// (IEEE 1666-2011, 15.2.6 and 14.5): order of phases, one request and one response at a time on a socket,
/// one response per request, times that do not go back, a response status, live payloads with a memory
/// manager.
class ProtocolChecker : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<ProtocolChecker> in{"in"};
  tlm_utils::simple_initiator_socket<ProtocolChecker> out{"out"};

  explicit ProtocolChecker(const sc_core::sc_module_name& name) : sc_module(name) {
    in.register_b_transport(this, &ProtocolChecker::b_transport);
    in.register_nb_transport_fw(this, &ProtocolChecker::nb_transport_fw);
    in.register_transport_dbg(this, &ProtocolChecker::transport_dbg);
    in.register_get_direct_mem_ptr(this, &ProtocolChecker::get_direct_mem_ptr);
    out.register_nb_transport_bw(this, &ProtocolChecker::nb_transport_bw);
    out.register_invalidate_direct_mem_ptr(this, &ProtocolChecker::invalidate_direct_mem_ptr);
  }

  const std::vector<std::string>& violations() const { return violations_; }
  /// Number of transactions that have begun and not ended.
  std::size_t active() const { return active_.size(); }
  std::size_t transactions() const { return transactions_; }
  std::size_t most_active() const { return most_active_; }

 private:
  using Payload = tlm::tlm_generic_payload;
  enum class State { requested, accepted, responding };
  struct Transaction {
    State state = State::requested;
    sc_core::sc_time latest;  ///< time of the latest phase
  };

  void expect(bool holds, const char* rule) {
    if (!holds) violations_.emplace_back(rule);
  }

  void b_transport(Payload& payload, sc_core::sc_time& delay) { out->b_transport(payload, delay); }
  unsigned int transport_dbg(Payload& payload) { return out->transport_dbg(payload); }
  bool get_direct_mem_ptr(Payload& payload, tlm::tlm_dmi& dmi) {
    return out->get_direct_mem_ptr(payload, dmi);
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) {
    in->invalidate_direct_mem_ptr(start, end);
  }

  tlm::tlm_sync_enum nb_transport_fw(Payload& payload, tlm::tlm_phase& phase, sc_core::sc_time& delay) {
    expect(payload.has_mm() && payload.get_ref_count() > 0, "a payload has a memory manager and is alive");
    const tlm::tlm_phase sent = phase;
    if (sent == tlm::BEGIN_REQ) {
      begin_request(payload, delay);
    } else if (sent == tlm::END_RESP) {
      end_response(payload, delay);
    } else {
      expect(false, "forward phases are BEGIN_REQ and END_RESP");
    }
    const tlm::tlm_sync_enum answer = out->nb_transport_fw(payload, phase, delay);
    if (sent == tlm::END_RESP) return answer;
    if (answer == tlm::TLM_COMPLETED) {
      end_request(payload, delay);
      begin_response(payload, delay);
      end_response(payload, delay);
    } else if (answer == tlm::TLM_UPDATED) {
      backward_phase(payload, phase, delay);
    }
    return answer;
  }

  tlm::tlm_sync_enum nb_transport_bw(Payload& payload, tlm::tlm_phase& phase, sc_core::sc_time& delay) {
    const tlm::tlm_phase sent = phase;
    backward_phase(payload, sent, delay);
    const tlm::tlm_sync_enum answer = in->nb_transport_bw(payload, phase, delay);
    if (answer == tlm::TLM_UPDATED) expect(phase == tlm::END_RESP, "a response is answered by END_RESP");
    if (sent == tlm::BEGIN_RESP && answer != tlm::TLM_ACCEPTED) end_response(payload, delay);
    return answer;
  }

  void backward_phase(Payload& payload, const tlm::tlm_phase& phase, const sc_core::sc_time& delay) {
    if (phase == tlm::END_REQ) {
      expect(is_in(payload, State::requested), "END_REQ follows BEGIN_REQ");
      end_request(payload, delay);
    } else if (phase == tlm::BEGIN_RESP) {
      expect(active_.count(&payload) == 1, "a response answers a request");
      if (is_in(payload, State::requested)) end_request(payload, delay);  // BEGIN_RESP implies END_REQ
      begin_response(payload, delay);
    } else {
      expect(false, "backward phases are END_REQ and BEGIN_RESP");
    }
  }

  void begin_request(Payload& payload, const sc_core::sc_time& delay) {
    expect(active_.count(&payload) == 0, "a payload is in one transaction at a time");
    expect(request_ == nullptr && sc_core::sc_time_stamp() + delay >= request_free_, "one request at a time");
    expect(payload.get_response_status() == tlm::TLM_INCOMPLETE_RESPONSE, "a request has no response status");
    request_ = &payload;
    active_[&payload] = {};
    ++transactions_;
    most_active_ = std::max(most_active_, active_.size());
    advance(payload, State::requested, delay);
  }
  void end_request(Payload& payload, const sc_core::sc_time& delay) {
    if (request_ == &payload) {
      request_ = nullptr;
      request_free_ = sc_core::sc_time_stamp() + delay;
    }
    advance(payload, State::accepted, delay);
  }
  void begin_response(Payload& payload, const sc_core::sc_time& delay) {
    expect(!is_in(payload, State::responding), "one response a request");
    expect(response_ == nullptr && sc_core::sc_time_stamp() + delay >= response_free_,
           "one response at a time");
    expect(payload.get_response_status() != tlm::TLM_INCOMPLETE_RESPONSE, "a response has a status");
    response_ = &payload;
    advance(payload, State::responding, delay);
  }
  void end_response(Payload& payload, const sc_core::sc_time& delay) {
    expect(is_in(payload, State::responding), "END_RESP follows BEGIN_RESP");
    advance(payload, State::responding, delay);
    if (response_ == &payload) response_ = nullptr;
    response_free_ = sc_core::sc_time_stamp() + delay;
    active_.erase(&payload);
  }

  bool is_in(Payload& payload, State state) const {
    const auto found = active_.find(&payload);
    return found != active_.end() && found->second.state == state;
  }
  void advance(Payload& payload, State state, const sc_core::sc_time& delay) {
    const auto found = active_.find(&payload);
    if (found == active_.end()) return;
    const sc_core::sc_time at = sc_core::sc_time_stamp() + delay;
    expect(at >= found->second.latest, "phases of a transaction do not go back in time");
    found->second = {state, at};
  }

  std::vector<std::string> violations_;
  std::map<Payload*, Transaction> active_;
  std::size_t transactions_ = 0;
  std::size_t most_active_ = 0;
  Payload* request_ = nullptr;
  Payload* response_ = nullptr;
  sc_core::sc_time request_free_;
  sc_core::sc_time response_free_;
};

}  // namespace test_support
