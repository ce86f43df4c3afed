#include "model/network/clear_connect_timing.hpp"

#include <algorithm>

namespace model {
namespace {

Cycles cycles_at_width(std::uint64_t bytes, const Divisor& bytes_per_cycle) {
  return bytes_per_cycle.quotient(bytes + bytes_per_cycle.value() - 1);
}

}  // namespace

ClearConnectTiming::ClearConnectTiming(const ChipConfig::ClearConnect& config, int ddr_bytes_per_cycle)
    : packet_bytes_(std::uint64_t(config.packet_bytes)),
      link_bytes_per_cycle_(std::uint64_t(config.bytes_per_cycle)),
      hop_cycles_(config.hop_cycles),
      links_(kInitiators) {
  const int port = config.ddr_port_bytes_per_cycle;
  add_port({port > 0 ? port : ddr_bytes_per_cycle, config.hops_to_ddr});
}

Port ClearConnectTiming::add_port(const PortConfig& port) {
  ports_.push_back({Divisor(std::uint64_t(port.bytes_per_cycle)), Cycles(hop_cycles_) * Cycles(port.hops)});
  return static_cast<Port>(ports_.size() - 1);
}

Initiator ClearConnectTiming::add_initiator() {
  links_.emplace_back();
  return static_cast<Initiator>(links_.size() - 1);
}

Cycles ClearConnectTiming::port_cycles(std::uint64_t bytes, Port port) const {
  return cycles_at_width(bytes, ports_[std::size_t(port)].bytes_per_cycle);
}

ClearConnectTiming::Passage ClearConnectTiming::request(Initiator initiator, std::uint64_t packets,
                                                        Cycles now, Port port) {
  link(initiator).statistics.packets += packets;
  return send(initiator, port, packets, packets, now);
}

ClearConnectTiming::Passage ClearConnectTiming::forward(Initiator initiator, std::uint64_t bytes,
                                                        std::uint64_t packets, Cycles now, Port port) {
  link(initiator).statistics.packets += packets;
  link(initiator).statistics.bytes += bytes;
  return send(initiator, port, cycles_at_width(bytes, link_bytes_per_cycle_), port_cycles(bytes, port), now);
}

ClearConnectTiming::Passage ClearConnectTiming::send(Initiator initiator, Port to, Cycles link_cycles,
                                                     Cycles port_cycles, Cycles now) {
  Link& from = link(initiator);
  PortState& port = port_state(to);
  const Cycles link_start = std::max(now, from.forward_free);
  from.forward_free = link_start + link_cycles;
  const Cycles port_start = wait_for_port(from, port.forward_free, link_start + port.latency_cycles);
  port.forward_free = port_start + port_cycles;
  if (port.observer != nullptr) port.observer->passed(initiator, true, port_start, port.forward_free);
  return {port_start, std::max(port.forward_free, from.forward_free + port.latency_cycles),
          from.forward_free};
}

Cycles ClearConnectTiming::backward(Initiator initiator, std::uint64_t bytes, std::uint64_t packets,
                                    Cycles first, Cycles last, Port port) {
  Link& to = link(initiator);
  PortState& from = port_state(port);
  to.statistics.packets += packets;
  to.statistics.bytes += bytes;
  const Cycles port_start = wait_for_port(to, from.backward_free, first);
  from.backward_free = port_start + port_cycles(bytes, port);
  if (from.observer != nullptr) from.observer->passed(initiator, false, port_start, from.backward_free);
  to.backward_free = std::max(port_start, to.backward_free) + cycles_at_width(bytes, link_bytes_per_cycle_);
  return std::max({to.backward_free, from.backward_free, last}) + from.latency_cycles;
}

Cycles ClearConnectTiming::wait_for_port(Link& link, Cycles port_free, Cycles ready) {
  const Cycles start = std::max(ready, port_free);
  link.statistics.waiting_cycles += start - ready;
  return start;
}

}  // namespace model
