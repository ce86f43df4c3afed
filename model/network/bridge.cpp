#include "model/network/bridge.hpp"

#include <algorithm>
#include <cmath>

#include "model/time/annotated_delay.hpp"

namespace model {

BridgeTiming::BridgeTiming(const ChipConfig::Board& board, double chip_clock_hz)
    : chip_cycles_per_cycle_(chip_clock_hz / board.bridge_clock_hz),
      bytes_per_cycle_(board.bridge_bytes_per_cycle),
      latency_cycles_(Cycles(std::ceil(board.bridge_latency_cycles * chip_cycles_per_cycle_))) {}

Cycles BridgeTiming::data_cycles(std::uint64_t bytes) const {
  const double cycles = std::max(1.0, std::ceil(double(bytes) / bytes_per_cycle_));
  return Cycles(std::ceil(cycles * chip_cycles_per_cycle_));
}

BridgeTiming::Passage BridgeTiming::backward(std::uint64_t bytes, Cycles last) {
  const Cycles at_full_width = std::min(last, data_cycles(bytes));
  return cross(backward_free_, bytes, last - at_full_width, last);
}

BridgeTiming::Passage BridgeTiming::cross(Cycles& free, std::uint64_t bytes, Cycles first, Cycles last) {
  const Cycles start = std::max(first, free);
  ++statistics_.transactions;
  statistics_.bytes += bytes;
  statistics_.waiting_cycles += start - first;
  free = start + data_cycles(bytes);
  return {start + latency_cycles_, std::max(free, last) + latency_cycles_, free};
}

Bridge::Bridge(const sc_core::sc_module_name& name, const ChipConfig& chip, EventQueue* event_queue)
    : sc_module(name),
      clock_(chip.chip.clock_hz),
      timing_(chip.board, chip.chip.clock_hz),
      event_queue_(event_queue) {
  near_socket.register_b_transport(this, &Bridge::b_transport);
  near_socket.register_transport_dbg(this, &Bridge::transport_dbg);
  near_socket.register_get_direct_mem_ptr(this, &Bridge::get_direct_mem_ptr);
  far_socket.register_invalidate_direct_mem_ptr(this, &Bridge::invalidate_direct_mem_ptr);
  if (event_queue_ == nullptr) return;
  near_.emplace(*event_queue_, AtTarget::Owner{[this](auto& payload) { return pass_request(payload); },
                                               [this](auto& payload, auto& phase, auto& delay) {
                                                 return near_socket->nb_transport_bw(payload, phase, delay);
                                               }});
  far_.emplace(*event_queue_, far_socket,
               AtInitiator::Owner{[](auto&) {}, [this](auto& payload) { return pass_response(payload); }});
  near_socket.register_nb_transport_fw(this, &Bridge::nb_transport_fw);
  far_socket.register_nb_transport_bw(this, &Bridge::nb_transport_bw);
}

void Bridge::b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  const std::uint64_t bytes = transaction.get_data_length();
  const bool write = transaction.is_write();
  const BridgeTiming::Passage there = timing_.forward(write ? bytes : 0, cycle_of_delay(clock_, delay));
  delay = delay_until(clock_, there.first);
  far_socket->b_transport(transaction, delay);
  if (transaction.is_response_error()) return;
  const Cycles over = std::max(cycle_of_delay(clock_, delay), there.last);
  delay = delay_until(clock_, write ? over : timing_.backward(bytes, over).last);
}

Cycles Bridge::pass_request(tlm::tlm_generic_payload& near) {
  const std::uint64_t bytes = near.get_data_length();
  const BridgeTiming::Passage there = timing_.forward(near.is_write() ? bytes : 0, event_queue_->now());
  tlm::tlm_generic_payload& far = pool_.take(near.get_command(), near.get_address(), bytes);
  far.set_data_ptr(near.get_data_ptr());
  Origin* origin = far.get_extension<Origin>();
  if (origin == nullptr) far.set_extension(origin = new Origin);
  origin->payload = &near;
  origin->sent_whole = there.last;
  event_queue_->schedule(there.first, [this, &far] { far_->send(far); });
  return there.free;
}

Cycles Bridge::pass_response(tlm::tlm_generic_payload& far) {
  const Origin& origin = *far.get_extension<Origin>();
  tlm::tlm_generic_payload& near = *origin.payload;
  near.set_response_status(far.get_response_status());
  const Cycles now = event_queue_->now();
  Cycles over = std::max(now, origin.sent_whole);
  Cycles free = now;
  if (near.is_read() && near.is_response_ok()) {
    const BridgeTiming::Passage back = timing_.backward(near.get_data_length(), over);
    over = back.last;
    free = std::max(now, back.free);
  }
  event_queue_->schedule(over, [this, &near] { near_->respond(near); });
  far.release();
  return free;
}

}  // namespace model
