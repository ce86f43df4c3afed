#include "model/pio/pio_packets.hpp"

#include <algorithm>

namespace model {

PioPackets::PioPackets(EventQueue& event_queue, tlm::tlm_initiator_socket<>& memory, const ChipConfig& config,
                       const PioTiming& timing, MonoWindow& mono, Owner owner)
    : event_queue_(event_queue),
      memory_(memory),
      initiator_(
          event_queue, memory,
          {[this](auto& packet) { sent(packet); }, [this](auto& packet) { return responded(packet); }}),
      timing_(timing),
      mono_(mono),
      owner_(std::move(owner)),
      packet_bytes_(std::uint64_t(config.clear_connect.packet_bytes)),
      outstanding_packets_(std::size_t(config.pio.outstanding_packets)) {}

void PioPackets::start(int engine, const MonoPieces& pieces) {
  engines_[std::size_t(engine)] = {
      &pieces, PacketCursor(pieces, packet_bytes_), PacketCursor(pieces, packet_bytes_), false, 0, 0, 0};
  begin_phase(engine, Phase::setup, timing_.setup_cycles());
}

void PioPackets::step(int index) {
  Engine& engine = engines_[std::size_t(index)];
  if (engine.pieces == nullptr) return;
  send_packets(index);
  if (!engine.busy) begin_phase(index);
  if (!is_over(engine)) return;
  engine.pieces = nullptr;
  owner_.finished(index);
}

void PioPackets::send_packets(int index) {
  Engine& engine = engines_[std::size_t(index)];
  for (; packet_is_due(engine) && room(); engine.next_to_send.advance()) {
    const PacketCursor::Packet& next = engine.next_to_send.packet();
    tlm::tlm_generic_payload& packet = pool_.take(
        engine.pieces->write() ? tlm::TLM_WRITE_COMMAND : tlm::TLM_READ_COMMAND, next.address, next.bytes);
    if (engine.pieces->write())
      mono_.read(next.address, packet.get_data_ptr(), next.bytes, *memory_.operator->());
    on_the_way_.push_back({&packet, next.address, index});
    if (!initiator_.send(packet)) ++engine.unsent;
  }
}

bool PioPackets::packet_is_due(const Engine& engine) const {
  if (engine.next_to_send.at_end()) return false;
  const PacketCursor::Packet& packet = engine.next_to_send.packet();
  return (engine.pieces->write() ? packet.last_piece : packet.first_piece) < engine.addressed;
}

bool PioPackets::data_of_next_piece_are_there(const Engine& engine) const {
  return engine.moved < engine.addressed &&
         (engine.next_to_arrive.at_end() || engine.next_to_arrive.packet().first_piece > engine.moved);
}

void PioPackets::begin_phase(int index) {
  const Engine& engine = engines_[std::size_t(index)];
  const MonoPieces& pieces = *engine.pieces;
  if (engine.addressed < pieces.pieces() && !packet_is_due(engine) && room()) {
    begin_phase(index, Phase::address,
                timing_.address_cycles(pieces, engine.addressed) +
                    (pieces.write() ? timing_.data_cycles(pieces) : 0));
  } else if (!pieces.write() && data_of_next_piece_are_there(engine)) {
    begin_phase(index, Phase::data, timing_.data_cycles(pieces));
  }
}

void PioPackets::begin_phase(int index, Phase phase, Cycles cycles) {
  engines_[std::size_t(index)].busy = true;
  event_queue_.schedule(event_queue_.now() + cycles, [this, index, phase] { end_phase(index, phase); });
}

void PioPackets::end_phase(int index, Phase phase) {
  Engine& engine = engines_[std::size_t(index)];
  engine.busy = false;
  if (phase == Phase::address) ++engine.addressed;
  if (phase == Phase::data) ++engine.moved;
  if (phase == (engine.pieces->write() ? Phase::address : Phase::data))
    bytes_moved_ += std::uint64_t(engine.pieces->bytes_per_pe());
  step(index);
}

bool PioPackets::is_over(const Engine& engine) const {
  if (engine.busy) return false;
  if (!engine.pieces->write()) return engine.moved == engine.pieces->pieces();
  return engine.next_to_send.at_end() && engine.unsent == 0;
}

void PioPackets::refresh_writes_on_the_way() {
  for (const OnTheWay& way : on_the_way_)
    if (way.packet != nullptr && way.packet->is_write())
      mono_.read(way.address, way.packet->get_data_ptr(), way.packet->get_data_length(),
                 *memory_.operator->());
}

std::vector<PioPackets::OnTheWay>::iterator PioPackets::find(const tlm::tlm_generic_payload& packet) {
  return std::find_if(on_the_way_.begin(), on_the_way_.end(),
                      [&](const OnTheWay& way) { return way.packet == &packet; });
}

void PioPackets::sent(const tlm::tlm_generic_payload& packet) {
  const int index = find(packet)->engine;
  --engines_[std::size_t(index)].unsent;
  step(index);
}

void PioPackets::take_data(OnTheWay& way) {
  const int engine = way.engine;
  way.packet = nullptr;
  for (;;) {
    const auto first = std::find_if(on_the_way_.begin(), on_the_way_.end(),
                                    [&](const OnTheWay& other) { return is_read_of(engine, other); });
    if (first == on_the_way_.end() || first->packet != nullptr) return;
    engines_[std::size_t(engine)].next_to_arrive.advance();
    on_the_way_.erase(first);
  }
}

Cycles PioPackets::responded(tlm::tlm_generic_payload& packet) {
  if (packet.is_response_error()) owner_.failed(packet);
  const auto way = find(packet);
  if (packet.is_read()) {
    take_data(*way);
  } else {
    on_the_way_.erase(way);
  }
  packet.release();
  for (int index = 0; index < int(engines_.size()); ++index) step(index);
  return event_queue_.now();
}

}  // namespace model
