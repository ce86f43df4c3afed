#include "model/network/clear_connect_timing.hpp"

#include <algorithm>

namespace model {
namespace {

Cycles cycles_at_width(std::uint64_t bytes, const Divisor& bytes_per_cycle) {
  return bytes_per_cycle.quotient(bytes + bytes_per_cycle.value() - 1);
}

}  // namespace

ClearConnectTiming::ClearConnectTiming(const ChipConfig::ClearConnect& config, int ddr_port_bytes_per_cycle)
    : packet_bytes_(std::uint64_t(config.packet_bytes)),
      link_bytes_per_cycle_(std::uint64_t(config.bytes_per_cycle)),
      port_bytes_per_cycle_(std::uint64_t(ddr_port_bytes_per_cycle)),
      latency_cycles_(Cycles(config.hop_cycles) * Cycles(config.hops_to_ddr)) {}

Cycles ClearConnectTiming::port_cycles(std::uint64_t bytes) const {
  return cycles_at_width(bytes, port_bytes_per_cycle_);
}

ClearConnectTiming::Passage ClearConnectTiming::request(Initiator initiator, std::uint64_t packets,
                                                        Cycles now) {
  statistics_[std::size_t(initiator)].packets += packets;
  return send(initiator, packets, packets, now);
}

ClearConnectTiming::Passage ClearConnectTiming::forward(Initiator initiator, std::uint64_t bytes,
                                                        std::uint64_t packets, Cycles now) {
  statistics_[std::size_t(initiator)].packets += packets;
  statistics_[std::size_t(initiator)].bytes += bytes;
  return send(initiator, cycles_at_width(bytes, link_bytes_per_cycle_), port_cycles(bytes), now);
}

ClearConnectTiming::Passage ClearConnectTiming::send(Initiator initiator, Cycles link_cycles,
                                                     Cycles port_cycles, Cycles now) {
  Cycles& link_free = forward_link_free_[std::size_t(initiator)];
  const Cycles link_start = std::max(now, link_free);
  link_free = link_start + link_cycles;
  const Cycles port_start = wait_for_port(initiator, forward_port_free_, link_start + latency_cycles_);
  forward_port_free_ = port_start + port_cycles;
  if (observer_ != nullptr) observer_->passed(initiator, true, port_start, forward_port_free_);
  return {port_start, std::max(forward_port_free_, link_free + latency_cycles_), link_free};
}

Cycles ClearConnectTiming::backward(Initiator initiator, std::uint64_t bytes, std::uint64_t packets,
                                    Cycles first, Cycles last) {
  statistics_[std::size_t(initiator)].packets += packets;
  statistics_[std::size_t(initiator)].bytes += bytes;
  const Cycles port_start = wait_for_port(initiator, backward_port_free_, first);
  backward_port_free_ = port_start + port_cycles(bytes);
  if (observer_ != nullptr) observer_->passed(initiator, false, port_start, backward_port_free_);
  Cycles& link_free = backward_link_free_[std::size_t(initiator)];
  link_free = std::max(port_start, link_free) + cycles_at_width(bytes, link_bytes_per_cycle_);
  return std::max({link_free, backward_port_free_, last}) + latency_cycles_;
}

Cycles ClearConnectTiming::wait_for_port(Initiator initiator, Cycles& port_free, Cycles ready) {
  const Cycles start = std::max(ready, port_free);
  statistics_[std::size_t(initiator)].waiting_cycles += start - ready;
  return start;
}

}  // namespace model
