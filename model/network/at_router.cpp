#include "model/network/at_router.hpp"

#include <algorithm>

namespace model {

AtRouter::AtRouter(EventQueue& event_queue, ClearConnectTiming& timing, const AddressMap& map,
                   Backward backward)
    : event_queue_(event_queue), timing_(timing), map_(map), backward_(std::move(backward)) {}

void AtRouter::add_initiator() {
  const auto number = static_cast<int>(initiators_.size());
  initiators_.push_back(std::make_unique<AtTarget>(
      event_queue_,
      AtTarget::Owner{[this, number](auto& packet) { return pass_request(Initiator(number), packet); },
                      [this, number](auto& packet, auto& phase, auto& delay) {
                        return backward_(number, packet, phase, delay);
                      }}));
}

void AtRouter::add_memory(tlm::tlm_initiator_socket<>& socket) {
  memories_.push_back(std::make_unique<AtInitiator>(
      event_queue_, socket,
      AtInitiator::Owner{[](auto&) {}, [this](auto& packet) { return pass_response(packet); }}));
}

AtRouter::Route& AtRouter::route_of(tlm::tlm_generic_payload& packet) {
  Route* route = packet.get_extension<Route>();
  if (route == nullptr) packet.set_extension(route = new Route);
  return *route;
}

Cycles AtRouter::pass_request(Initiator initiator, tlm::tlm_generic_payload& packet) {
  const Cycles now = event_queue_.now();
  const std::uint64_t bytes = packet.get_data_length();
  Route& route = route_of(packet);
  route.initiator = initiator;
  const int found = map_.find(packet.get_address(), bytes);
  if (found == AddressMap::kNowhere) {
    packet.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    event_queue_.schedule(now, [this, &packet] { respond(packet); });
    return now;
  }
  route.port = static_cast<Port>(found);
  const std::uint64_t packets = timing_.packets_for(bytes);
  const ClearConnectTiming::Passage passage =
      packet.is_write() ? timing_.forward(initiator, bytes, packets, now, route.port)
                        : timing_.request(initiator, packets, now, route.port);
  route.sent_whole = passage.last;
  route.at_memory = passage.first;
  event_queue_.schedule(passage.first, [this, &packet] {
    const Route& way = route_of(packet);
    packet.set_address(packet.get_address() - map_[int(way.port)].mono.first);
    memories_[std::size_t(way.port)]->send(packet);
  });
  return passage.sent;
}

/// A memory begins its response when it has sent the last byte; it is taken to have sent at full width.
Cycles AtRouter::pass_response(tlm::tlm_generic_payload& packet) {
  const Route& route = route_of(packet);
  packet.set_address(packet.get_address() + map_[int(route.port)].mono.first);
  const Cycles now = event_queue_.now();
  Cycles there = std::max(now, route.sent_whole);
  Cycles port_free = now;
  if (packet.is_read() && packet.is_response_ok()) {
    const std::uint64_t bytes = packet.get_data_length();
    const Cycles at_full_width = timing_.port_cycles(bytes, route.port);
    const Cycles first = std::max(route.at_memory, now - std::min(now, at_full_width));
    there = timing_.backward(route.initiator, bytes, timing_.packets_for(bytes), first, now, route.port);
    port_free = std::max(now, timing_.backward_port_free(route.port));
  }
  event_queue_.schedule(there, [this, &packet] { respond(packet); });
  return port_free;
}

}  // namespace model
