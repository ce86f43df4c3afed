#include "model/network/clear_connect.hpp"

#include <algorithm>

#include "model/time/annotated_delay.hpp"
#include "model/transaction/pe_addresses.hpp"

namespace model {

ClearConnect::ClearConnect(const sc_core::sc_module_name& name, const ChipConfig& config,
                           const ClockDomain& clock, EventQueue* event_queue)
    : sc_module(name),
      clock_(clock),
      port_bytes_per_cycle_(std::uint64_t(config.ddr.bytes_per_cycle)),
      timing_(config.clear_connect, config.ddr.bytes_per_cycle) {
  if (event_queue != nullptr)
    at_router_.emplace(*event_queue, timing_, ddr_socket,
                       [this](int initiator, auto& transaction, auto& phase, auto& delay) {
                         return answer(initiator, transaction, phase, delay);
                       });
  register_socket(pio_socket, Initiator::pio);
  register_socket(control_socket, Initiator::control);
  register_socket(host_socket, Initiator::host);
  ddr_socket.register_invalidate_direct_mem_ptr(this, &ClearConnect::invalidate_direct_mem_ptr);
  if (at_router_) ddr_socket.register_nb_transport_bw(this, &ClearConnect::nb_transport_bw);
}

void ClearConnect::register_socket(tlm_utils::simple_target_socket_tagged<ClearConnect>& socket,
                                   Initiator initiator) {
  const int tag = static_cast<int>(initiator);
  socket.register_b_transport(this, &ClearConnect::b_transport, tag);
  socket.register_transport_dbg(this, &ClearConnect::transport_dbg, tag);
  socket.register_get_direct_mem_ptr(this, &ClearConnect::get_direct_mem_ptr, tag);
  if (at_router_) socket.register_nb_transport_fw(this, &ClearConnect::nb_transport_fw, tag);
}

void ClearConnect::b_transport(int initiator, tlm::tlm_generic_payload& transaction,
                               sc_core::sc_time& delay) {
  if (initiator != int(Initiator::host) && host_traffic.size() > 0)
    host_traffic->book_until(cycle_of_delay(clock_, delay));
  Load load{transaction.is_write(), 0, 0};
  if (transaction.is_read() || transaction.is_write()) {
    load.bytes = transaction.get_data_length();
    load.packets = timing_.packets_for(load.bytes);
  } else if (const auto* const addresses = transaction.get_extension<PeAddresses>()) {
    load = {addresses->pieces.write(), addresses->pieces.mono_bytes(), addresses->pieces.packets()};
  }
  if (load.packets == 0) {
    ddr_socket->b_transport(transaction, delay);
  } else if (load.write) {
    pass_write(static_cast<Initiator>(initiator), load, transaction, delay);
  } else {
    pass_read(static_cast<Initiator>(initiator), load, transaction, delay);
  }
}

void ClearConnect::pass_write(Initiator initiator, const Load& load, tlm::tlm_generic_payload& transaction,
                              sc_core::sc_time& delay) {
  const auto passage = timing_.forward(initiator, load.bytes, load.packets, cycle_of_delay(clock_, delay));
  delay = delay_until(clock_, passage.first);
  ddr_socket->b_transport(transaction, delay);
  delay = std::max(delay, delay_until(clock_, passage.last));
}

void ClearConnect::pass_read(Initiator initiator, const Load& load, tlm::tlm_generic_payload& transaction,
                             sc_core::sc_time& delay) {
  const auto passage = timing_.request(initiator, load.packets, cycle_of_delay(clock_, delay));
  delay = delay_until(clock_, passage.first);
  ddr_socket->b_transport(transaction, delay);
  if (transaction.is_response_error()) return;
  const Cycles last = cycle_of_delay(clock_, delay);
  // A memory says when its last byte was sent, only PeAddresses say when the first was: it is taken to have
  // sent at full width.
  const auto* const addresses = transaction.get_extension<PeAddresses>();
  const Cycles at_full_width = port_bytes_per_cycle_.quotient(load.bytes + port_bytes_per_cycle_.value() - 1);
  const Cycles first = addresses != nullptr && addresses->served
                           ? cycle_of_delay(clock_, addresses->first_data)
                           : std::max(passage.first, last - std::min(last, at_full_width));
  delay = delay_until(clock_, timing_.backward(initiator, load.bytes, load.packets, first, last));
}

tlm::tlm_sync_enum ClearConnect::nb_transport_fw(int initiator, tlm::tlm_generic_payload& transaction,
                                                 tlm::tlm_phase& phase, sc_core::sc_time& delay) {
  return at_router_->nb_transport_fw(initiator, transaction, phase, delay);
}

tlm::tlm_sync_enum ClearConnect::nb_transport_bw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                                 sc_core::sc_time& delay) {
  return at_router_->nb_transport_bw(transaction, phase, delay);
}

tlm::tlm_sync_enum ClearConnect::answer(int initiator, tlm::tlm_generic_payload& transaction,
                                        tlm::tlm_phase& phase, sc_core::sc_time& delay) {
  auto& socket = initiator == int(Initiator::pio)       ? pio_socket
                 : initiator == int(Initiator::control) ? control_socket
                                                        : host_socket;
  return socket->nb_transport_bw(transaction, phase, delay);
}

unsigned int ClearConnect::transport_dbg(int, tlm::tlm_generic_payload& transaction) {
  return ddr_socket->transport_dbg(transaction);
}

bool ClearConnect::get_direct_mem_ptr(int, tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi) {
  return ddr_socket->get_direct_mem_ptr(transaction, dmi);
}

void ClearConnect::invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end) {
  pio_socket->invalidate_direct_mem_ptr(start, end);
  control_socket->invalidate_direct_mem_ptr(start, end);
  host_socket->invalidate_direct_mem_ptr(start, end);
}

}  // namespace model
