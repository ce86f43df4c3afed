#include "model/network/clear_connect.hpp"

#include <algorithm>

#include "model/time/annotated_delay.hpp"
#include "model/transaction/pe_addresses.hpp"

namespace model {

ClearConnect::ClearConnect(const sc_core::sc_module_name& name, const ChipConfig& config,
                           const ClockDomain& clock, EventQueue* event_queue)
    : sc_module(name), clock_(clock), timing_(config.clear_connect, config.ddr.bytes_per_cycle) {
  if (event_queue != nullptr)
    at_router_.emplace(*event_queue, timing_, map_,
                       [this](int initiator, auto& transaction, auto& phase, auto& delay) {
                         return answer(initiator, transaction, phase, delay);
                       });
  register_socket(pio_socket, Initiator::pio);
  register_socket(control_socket, Initiator::control);
  register_socket(host_socket, Initiator::host);
  map_.add(kDdrRange, {0, config.ddr.size_bytes});
  register_socket(ddr_socket, Port::ddr);
}

Port ClearConnect::bind(tlm::tlm_base_target_socket_b<>& memory, const std::string& name,
                        const cn::MonoRange& range, const PortConfig& config) {
  map_.add(name, range);
  const Port port = timing_.add_port(config);
  more_memories_.push_back(std::make_unique<Joined<MemorySocket>>(name_of_joined(name).c_str()));
  MemorySocket& socket = more_memories_.back()->socket;
  register_socket(socket, port);
  socket.bind(memory);
  return port;
}

Initiator ClearConnect::bind_initiator(tlm::tlm_base_initiator_socket_b<>& initiator) {
  const Initiator number = timing_.add_initiator();
  more_initiators_.push_back(std::make_unique<Joined<InitiatorSocket>>(
      name_of_joined("initiator_" + std::to_string(int(number))).c_str()));
  InitiatorSocket& socket = more_initiators_.back()->socket;
  register_socket(socket, number);
  socket.bind(initiator);
  return number;
}

/// Told apart from those of other chips, whose modules may be siblings.
std::string ClearConnect::name_of_joined(const std::string& name) const {
  std::string path = std::string(this->name()) + "_" + name;
  std::replace(path.begin(), path.end(), '.', '_');
  return path;
}

void ClearConnect::register_socket(MemorySocket& socket, Port port) {
  const int tag = static_cast<int>(port);
  memories_.push_back(&socket);
  socket.register_invalidate_direct_mem_ptr(this, &ClearConnect::invalidate_direct_mem_ptr, tag);
  if (!at_router_) return;
  socket.register_nb_transport_bw(this, &ClearConnect::nb_transport_bw, tag);
  at_router_->add_memory(socket);
}

void ClearConnect::register_socket(InitiatorSocket& socket, Initiator initiator) {
  const int tag = static_cast<int>(initiator);
  initiators_.push_back(&socket);
  if (at_router_) at_router_->add_initiator();
  socket.register_b_transport(this, &ClearConnect::b_transport, tag);
  socket.register_transport_dbg(this, &ClearConnect::transport_dbg, tag);
  socket.register_get_direct_mem_ptr(this, &ClearConnect::get_direct_mem_ptr, tag);
  if (at_router_) socket.register_nb_transport_fw(this, &ClearConnect::nb_transport_fw, tag);
}

void ClearConnect::b_transport(int initiator, tlm::tlm_generic_payload& transaction,
                               sc_core::sc_time& delay) {
  if (initiator != int(Initiator::host)) book_until(booked_traffic, cycle_of_delay(clock_, delay));
  const bool moves_data = transaction.is_read() || transaction.is_write();
  const std::uint64_t bytes = moves_data ? transaction.get_data_length() : 0;
  const int port = map_.find(transaction.get_address(), bytes);
  if (port == AddressMap::kNowhere) return transaction.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
  Load load{static_cast<Port>(port), transaction.is_write(), bytes, timing_.packets_for(bytes)};
  if (const auto* const addresses = moves_data ? nullptr : transaction.get_extension<PeAddresses>()) {
    const MonoPieces& pieces = addresses->pieces;
    if (!pieces.within(map_[int(Port::ddr)].mono.bytes))  // not served: one transaction a run will follow
      return transaction.set_response_status(tlm::TLM_OK_RESPONSE);
    load = {Port::ddr, pieces.write(), pieces.mono_bytes(), pieces.packets()};
  }
  if (load.packets == 0) {
    pass_on(load.port, transaction, delay);
  } else if (load.write) {
    pass_write(static_cast<Initiator>(initiator), load, transaction, delay);
  } else {
    pass_read(static_cast<Initiator>(initiator), load, transaction, delay);
  }
}

/// The transaction's own address comes back, as its initiator may look at it.
void ClearConnect::pass_on(Port port, tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay) {
  const std::uint64_t address = transaction.get_address();
  transaction.set_address(local(address, port));
  memory(port)->b_transport(transaction, delay);
  transaction.set_address(address);
}

void ClearConnect::pass_write(Initiator initiator, const Load& load, tlm::tlm_generic_payload& transaction,
                              sc_core::sc_time& delay) {
  const auto passage =
      timing_.forward(initiator, load.bytes, load.packets, cycle_of_delay(clock_, delay), load.port);
  delay = delay_until(clock_, passage.first);
  pass_on(load.port, transaction, delay);
  delay = std::max(delay, delay_until(clock_, passage.last));
}

void ClearConnect::pass_read(Initiator initiator, const Load& load, tlm::tlm_generic_payload& transaction,
                             sc_core::sc_time& delay) {
  const auto passage = timing_.request(initiator, load.packets, cycle_of_delay(clock_, delay), load.port);
  delay = delay_until(clock_, passage.first);
  pass_on(load.port, transaction, delay);
  if (transaction.is_response_error()) return;
  const Cycles last = cycle_of_delay(clock_, delay);
  // A memory says when its last byte was sent, only PeAddresses say when the first was: it is taken to have
  // sent at full width.
  const auto* const addresses = transaction.get_extension<PeAddresses>();
  const Cycles at_full_width = timing_.port_cycles(load.bytes, load.port);
  const Cycles first = addresses != nullptr && addresses->served
                           ? cycle_of_delay(clock_, addresses->first_data)
                           : std::max(passage.first, last - std::min(last, at_full_width));
  delay = delay_until(clock_, timing_.backward(initiator, load.bytes, load.packets, first, last, load.port));
}

tlm::tlm_sync_enum ClearConnect::nb_transport_fw(int initiator, tlm::tlm_generic_payload& transaction,
                                                 tlm::tlm_phase& phase, sc_core::sc_time& delay) {
  return at_router_->nb_transport_fw(initiator, transaction, phase, delay);
}

tlm::tlm_sync_enum ClearConnect::nb_transport_bw(int port, tlm::tlm_generic_payload& transaction,
                                                 tlm::tlm_phase& phase, sc_core::sc_time& delay) {
  return at_router_->nb_transport_bw(static_cast<Port>(port), transaction, phase, delay);
}

tlm::tlm_sync_enum ClearConnect::answer(int initiator, tlm::tlm_generic_payload& transaction,
                                        tlm::tlm_phase& phase, sc_core::sc_time& delay) {
  return (*initiators_[std::size_t(initiator)])->nb_transport_bw(transaction, phase, delay);
}

unsigned int ClearConnect::transport_dbg(int, tlm::tlm_generic_payload& transaction) {
  const std::uint64_t address = transaction.get_address();
  const int found = map_.find(address, 1);
  if (found == AddressMap::kNowhere) return 0;
  const auto port = static_cast<Port>(found);
  transaction.set_address(local(address, port));
  const unsigned int moved = memory(port)->transport_dbg(transaction);
  transaction.set_address(address);
  return moved;
}

bool ClearConnect::get_direct_mem_ptr(int, tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi) {
  const std::uint64_t address = transaction.get_address();
  const int found = map_.find(address, 1);
  if (found == AddressMap::kNowhere) {
    dmi.init();
    dmi.set_start_address(address);
    dmi.set_end_address(address);
    return false;
  }
  const auto port = static_cast<Port>(found);
  const cn::MonoRange& range = map_[found].mono;
  transaction.set_address(local(address, port));
  const bool granted = memory(port)->get_direct_mem_ptr(transaction, dmi);
  transaction.set_address(address);
  // A memory may be larger than its range, and says so with the greatest address when it refuses all.
  dmi.set_end_address(range.first + std::min<std::uint64_t>(dmi.get_end_address(), range.bytes - 1));
  dmi.set_start_address(range.first + dmi.get_start_address());
  return granted;
}

void ClearConnect::invalidate_direct_mem_ptr(int port, sc_dt::uint64 start, sc_dt::uint64 end) {
  const cn::MonoRange& range = map_[port].mono;
  const std::uint64_t last = range.first + std::min<std::uint64_t>(end, range.bytes - 1);
  for (InitiatorSocket* const initiator : initiators_)
    (*initiator)->invalidate_direct_mem_ptr(range.first + start, last);
}

}  // namespace model
