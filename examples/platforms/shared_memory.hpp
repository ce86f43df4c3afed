#pragma once

#include <tlm_utils/peq_with_get.h>
#include <tlm_utils/simple_target_socket.h>
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

namespace examples {

/// A memory with one port and a socket for each initiator, as a third party would write it: b_transport,
/// the four phases, debug transport and a direct pointer; no extensions. Accesses occupy the port one after
/// the other in the order in which they come; any number may be on the way.
class SharedMemory : public sc_core::sc_module {
 public:
  struct Access {
    int initiator;
    bool write;
    std::uint64_t address;
    std::uint64_t bytes;
    sc_core::sc_time start;  ///< when the port begins with it
    sc_core::sc_time end;    ///< when the port is free again
  };
  using Observer = std::function<void(const Access&)>;

  sc_core::sc_vector<tlm_utils::simple_target_socket_tagged<SharedMemory>> sockets;

  SharedMemory(const sc_core::sc_module_name& name, int initiators, std::uint64_t size_bytes,
               double bytes_per_second, const sc_core::sc_time& latency)
      : sc_module(name),
        sockets("socket", static_cast<unsigned int>(initiators)),
        bytes_(size_bytes),
        seconds_per_byte_(1 / bytes_per_second),
        latency_(latency) {
    for (int i = 0; i < initiators; ++i) {
      auto& socket = sockets[std::size_t(i)];
      socket.register_nb_transport_fw(this, &SharedMemory::nb_transport_fw, i);
      socket.register_b_transport(this, &SharedMemory::b_transport, i);
      socket.register_transport_dbg(this, &SharedMemory::transport_dbg, i);
      socket.register_get_direct_mem_ptr(this, &SharedMemory::get_direct_mem_ptr, i);
      responses_.push_back(std::make_unique<Responses>());
    }
    SC_HAS_PROCESS(SharedMemory);
    SC_METHOD(begin_responses);
    sensitive << ended_;
    for (const auto& responses : responses_) sensitive << responses->due.get_event();
    dont_initialize();
  }

  /// Tells `observer` of each access from now on.
  void set_observer(Observer observer) { observer_ = std::move(observer); }
  std::uint8_t* data() { return bytes_.data(); }
  /// Total time in which the port was occupied.
  const sc_core::sc_time& busy() const { return busy_; }

 private:
  /// The responses to one initiator, which begin one after the other.
  struct Responses {
    tlm_utils::peq_with_get<tlm::tlm_generic_payload> due{sc_core::sc_gen_unique_name("responses")};
    tlm::tlm_generic_payload* begun = nullptr;
  };

  tlm::tlm_sync_enum nb_transport_fw(int initiator, tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    Responses& responses = *responses_[std::size_t(initiator)];
    if (phase == tlm::END_RESP) {
      std::exchange(responses.begun, nullptr)->release();
      ended_.notify(delay);
      return tlm::TLM_COMPLETED;
    }
    if (phase != tlm::BEGIN_REQ) return tlm::TLM_ACCEPTED;
    payload.acquire();
    sc_core::sc_time over = delay;
    b_transport(initiator, payload, over);
    responses.due.notify(payload, over);
    phase = tlm::END_REQ;
    return tlm::TLM_UPDATED;
  }

  void begin_responses() {
    for (std::size_t i = 0; i < responses_.size(); ++i) {
      Responses& responses = *responses_[i];
      while (responses.begun == nullptr) {
        responses.begun = responses.due.get_next_transaction();
        if (responses.begun == nullptr) break;
        tlm::tlm_phase phase = tlm::BEGIN_RESP;
        sc_core::sc_time delay;
        if (sockets[i]->nb_transport_bw(*responses.begun, phase, delay) == tlm::TLM_ACCEPTED) continue;
        std::exchange(responses.begun, nullptr)->release();
      }
    }
  }

  void b_transport(int initiator, tlm::tlm_generic_payload& payload, sc_core::sc_time& delay) {
    const bool moves = payload.is_read() || payload.is_write();
    if (moves && transport_dbg(initiator, payload) != payload.get_data_length()) {
      payload.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
      return;
    }
    if (moves)
      delay = occupy_port(initiator, payload, sc_core::sc_time_stamp() + delay) - sc_core::sc_time_stamp();
    payload.set_response_status(tlm::TLM_OK_RESPONSE);
  }

  /// Returns when an access that arrives at `arrival` is over.
  sc_core::sc_time occupy_port(int initiator, const tlm::tlm_generic_payload& payload,
                               const sc_core::sc_time& arrival) {
    const std::uint64_t bytes = payload.get_data_length();
    const sc_core::sc_time start = std::max(arrival, port_free_);
    const sc_core::sc_time duration(double(bytes) * seconds_per_byte_, sc_core::SC_SEC);
    port_free_ = start + duration;
    busy_ += duration;
    if (observer_)
      observer_({initiator, payload.is_write(), payload.get_address(), bytes, start, port_free_});
    return port_free_ + latency_;
  }

  unsigned int transport_dbg(int, tlm::tlm_generic_payload& payload) {
    const std::uint64_t address = payload.get_address();
    const unsigned int length = payload.get_data_length();
    if (address > bytes_.size() || length > bytes_.size() - address) return 0;
    if (payload.is_read()) std::memcpy(payload.get_data_ptr(), bytes_.data() + address, length);
    if (payload.is_write()) std::memcpy(bytes_.data() + address, payload.get_data_ptr(), length);
    return length;
  }

  bool get_direct_mem_ptr(int, tlm::tlm_generic_payload&, tlm::tlm_dmi& dmi) {
    dmi.set_start_address(0);
    dmi.set_end_address(bytes_.size() - 1);
    dmi.set_dmi_ptr(bytes_.data());
    dmi.allow_read_write();
    return true;
  }

  std::vector<std::uint8_t> bytes_;
  double seconds_per_byte_;
  sc_core::sc_time latency_;
  sc_core::sc_time port_free_;
  sc_core::sc_time busy_;
  Observer observer_;
  std::vector<std::unique_ptr<Responses>> responses_;  ///< by initiator
  sc_core::sc_event ended_;
};

}  // namespace examples
