#include "model/network/at_router.hpp"

#include <algorithm>

namespace model {

AtRouter::AtRouter(EventQueue& event_queue, ClearConnectTiming& timing, tlm::tlm_initiator_socket<>& memory,
                   const Backward& backward)
    : event_queue_(event_queue),
      timing_(timing),
      memory_(event_queue, memory, {[](auto&) {}, [this](auto& packet) { return pass_response(packet); }}) {
  for (int i = 0; i < int(kInitiators); ++i) {
    initiators_[std::size_t(i)].emplace(
        event_queue, AtTarget::Owner{[this, i](auto& packet) { return pass_request(Initiator(i), packet); },
                                     [backward, i](auto& packet, auto& phase, auto& delay) {
                                       return backward(i, packet, phase, delay);
                                     }});
  }
}

AtRouter::Route& AtRouter::route_of(tlm::tlm_generic_payload& packet) {
  Route* route = packet.get_extension<Route>();
  if (route == nullptr) packet.set_extension(route = new Route);
  return *route;
}

Cycles AtRouter::pass_request(Initiator initiator, tlm::tlm_generic_payload& packet) {
  const Cycles now = event_queue_.now();
  const std::uint64_t bytes = packet.get_data_length();
  const std::uint64_t packets = timing_.packets_for(bytes);
  const ClearConnectTiming::Passage passage = packet.is_write()
                                                  ? timing_.forward(initiator, bytes, packets, now)
                                                  : timing_.request(initiator, packets, now);
  Route& route = route_of(packet);
  route.initiator = initiator;
  route.sent_whole = passage.last;
  route.at_memory = passage.first;
  event_queue_.schedule(passage.first, [this, &packet] { memory_.send(packet); });
  return passage.sent;
}

/// A memory begins its response when it has sent the last byte; it is taken to have sent at full width.
Cycles AtRouter::pass_response(tlm::tlm_generic_payload& packet) {
  const Route& route = route_of(packet);
  const Cycles now = event_queue_.now();
  Cycles there = std::max(now, route.sent_whole);
  Cycles port_free = now;
  if (packet.is_read() && packet.is_response_ok()) {
    const std::uint64_t bytes = packet.get_data_length();
    const Cycles at_full_width = timing_.port_cycles(bytes);
    const Cycles first = std::max(route.at_memory, now - std::min(now, at_full_width));
    there = timing_.backward(route.initiator, bytes, timing_.packets_for(bytes), first, now);
    port_free = std::max(now, timing_.backward_port_free());
  }
  event_queue_.schedule(
      there, [this, &packet] { initiators_[std::size_t(route_of(packet).initiator)]->respond(packet); });
  return port_free;
}

}  // namespace model
