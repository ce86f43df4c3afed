#include "model/host_link/host_link.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "model/time/annotated_delay.hpp"
#include "model/transaction/payload.hpp"

namespace model {

HostLink::HostLink(const sc_core::sc_module_name& name, const ChipConfig& config, EventQueue* event_queue)
    : sc_module(name),
      clock_(config.chip.clock_hz),
      board_(config.board),
      timing_(config),
      event_queue_(event_queue) {
  traffic.bind(*this);
  if (event_queue_ == nullptr) return;
  at_initiator_ = std::make_unique<AtInitiator>(
      *event_queue_, socket,
      AtInitiator::Owner{[](auto&) {}, [this](auto& packet) { return take_response(packet); }});
  socket.register_nb_transport_bw(this, &HostLink::nb_transport_bw);
}

Cycles HostLink::upload(cn::MonoAddress to, const void* from, std::uint64_t bytes, Cycles now) {
  statistics_.bytes_uploaded += bytes;
  // The generic payload has one pointer for both directions; a write command does not change what it points
  // at.
  auto* const data = static_cast<unsigned char*>(const_cast<void*>(from));
  return transfer(tlm::TLM_WRITE_COMMAND, to, data, bytes, now);
}

Cycles HostLink::download(cn::MonoAddress from, void* to, std::uint64_t bytes, Cycles now) {
  statistics_.bytes_downloaded += bytes;
  return transfer(tlm::TLM_READ_COMMAND, from, static_cast<unsigned char*>(to), bytes, now);
}

Cycles HostLink::transfer(tlm::tlm_command command, cn::MonoAddress address, unsigned char* data,
                          std::uint64_t bytes, Cycles now) {
  while (sending_ != nullptr) wait(answered_);  // another process's transfer; approximately timed only
  const Cycles start = std::max(now, *link_free_);
  const bool upload = command == tlm::TLM_WRITE_COMMAND;
  if (observer_ != nullptr) observer_->began_transfer(upload, bytes, start);
  Cycles end = start;
  for (std::uint64_t done = 0; done < bytes;) {
    const std::uint64_t dma_bytes = std::min(bytes - done, kMaxDmaBytes);
    if (!move(command, address + done, data + done, dma_bytes))
      throw std::out_of_range("host link: " + std::to_string(bytes) + " bytes at mono address " +
                              std::to_string(address) + " do not fit mono memory");
    end += timing_.dma_cycles(dma_bytes);
    ++statistics_.transfers;
    done += dma_bytes;
  }
  *link_free_ = end;
  HostPackets packets(timing_, command, address, bytes, start);
  if (event_queue_ != nullptr) {
    end = wait_for_packets(packets, end);
  } else if (bytes > 0) {
    unbooked_.push_back(packets);
  }
  statistics_.busy_cycles += end - start;
  if (observer_ != nullptr) observer_->ended_transfer(upload, bytes, start, end);
  free_at_ = clock_.time_at(end);
  *link_free_ = std::max(*link_free_, end);
  return end;
}

bool HostLink::move(tlm::tlm_command command, cn::MonoAddress address, unsigned char* data,
                    std::uint64_t bytes) {
  tlm::tlm_generic_payload transaction;
  set_access(transaction, command, address, data, bytes);
  return socket->transport_dbg(transaction) == bytes;
}

bool HostLink::in_progress() const {
  return event_queue_ == nullptr && free_at_ > sc_core::sc_time_stamp();
}

void HostLink::book_until(Cycles cycle) {
  while (!unbooked_.empty()) {
    HostPackets& packets = unbooked_.front();
    for (; !packets.at_end(); packets.advance()) {
      if (packets.due() > cycle) return;
      if (clock_.time_at(packets.due()) >= sc_core::sc_time_stamp()) book(packets);
    }
    unbooked_.erase(unbooked_.begin());
  }
}

void HostLink::book(const HostPackets& packets) {
  tlm::tlm_generic_payload& packet = take_packet(packets);
  sc_core::sc_time delay = delay_until(clock_, packets.due());
  socket->b_transport(packet, delay);
  packet.release();
}

/// Fills a write with what memory holds already, so it changes no data.
tlm::tlm_generic_payload& HostLink::take_packet(const HostPackets& packets) {
  tlm::tlm_generic_payload& packet = pool_.take(tlm::TLM_READ_COMMAND, packets.address(), packets.bytes());
  if (packets.command() == tlm::TLM_WRITE_COMMAND) socket->transport_dbg(packet);
  packet.set_command(packets.command());
  packet.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
  return packet;
}

Cycles HostLink::wait_for_packets(HostPackets& packets, Cycles link_end) {
  sending_ = &packets;
  send_due();
  while (!packets.at_end() || on_the_way_ > 0) wait(answered_);
  sending_ = nullptr;
  answered_.notify(sc_core::SC_ZERO_TIME);
  return std::max(link_end, event_queue_->now());
}

void HostLink::send_due() {
  while (sending_ != nullptr && !sending_->at_end() && !send_asked_ && on_the_way_ < kOutstandingPackets) {
    if (sending_->due() > event_queue_->now()) {
      send_asked_ = true;
      event_queue_->schedule(sending_->due(), [this] {
        send_asked_ = false;
        send_due();
      });
      return;
    }
    ++on_the_way_;
    at_initiator_->send(take_packet(*sending_));
    sending_->advance();
  }
}

Cycles HostLink::take_response(tlm::tlm_generic_payload& packet) {
  --on_the_way_;
  packet.release();
  send_due();
  answered_.notify(sc_core::SC_ZERO_TIME);
  return event_queue_->now();
}

tlm::tlm_sync_enum HostLink::nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                             sc_core::sc_time& delay) {
  return at_initiator_->nb_transport_bw(packet, phase, delay);
}

}  // namespace model
