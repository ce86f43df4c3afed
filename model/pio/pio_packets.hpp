#pragma once

#include <array>
#include <functional>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/memory/mono_window.hpp"
#include "model/pio/pio_timing.hpp"
#include "model/time/event_queue.hpp"
#include "model/transaction/at_initiator.hpp"
#include "model/transaction/packet_cursor.hpp"
#include "model/transaction/payload_pool.hpp"

namespace model {

/// The packets of the requests in service, approximately timed. Each packet of mono memory is one
/// transaction, so that other initiators get in between, and is sent when the engine has come to its PE.
///
/// An engine does one thing at a time, for as long as PioTiming says: setup, then PE by PE the address phase
/// and the data phase.
/// - Read: packets leave after the address phase of the first PE that they hold data for, at most
///   pio.outstanding_packets at a time. The engine takes further addresses as long as it may send their
///   packets, and writes data into a PE when they have arrived. The request is over with the last PE's data.
/// - Write: address and data phase of a PE follow each other; a packet leaves when its last byte has come
///   out of a PE. Posted: the request is over when its last packet has left the engine.
///
/// Reads that lie in several memories may be answered in another order. Data then keep their place among the
/// outstanding packets until all before them are there.
///
/// Data have moved when the request was queued; packets carry them once more. A write that is on the way is
/// kept equal to what memory holds, so that none brings back what a later request has replaced.
class PioPackets {
 public:
  struct Owner {
    std::function<void(int engine)> finished;
    std::function<void(const tlm::tlm_generic_payload&)> failed;  ///< memory has answered with an error
  };

  PioPackets(EventQueue& event_queue, tlm::tlm_initiator_socket<>& memory, const ChipConfig& config,
             const PioTiming& timing, MonoWindow& mono, Owner owner);

  /// `pieces` must last until the engine has finished.
  void start(int engine, const MonoPieces& pieces);
  /// To be called when a request has changed data in mono memory.
  void refresh_writes_on_the_way();
  /// 8-byte words that have gone through PEs' SRAM ports.
  std::uint64_t words_moved() const { return bytes_moved_ / 8; }

  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return initiator_.nb_transport_bw(packet, phase, delay);
  }

 private:
  struct Engine {
    const MonoPieces* pieces = nullptr;  ///< pieces of the request in service; null: none
    PacketCursor next_to_send;
    PacketCursor next_to_arrive;
    bool busy = false;  ///< in a phase that is not over
    int addressed = 0;  ///< pieces whose addresses are sent
    int moved = 0;      ///< pieces of a read that are in their PEs
    int unsent = 0;     ///< packets that wait for the link
  };
  enum class Phase : std::uint8_t { setup, address, data };
  struct OnTheWay {
    tlm::tlm_generic_payload* packet;  ///< null: its data are there
    cn::MonoAddress address;
    int engine;
  };

  /// Does what can be done in this cycle.
  void step(int index);
  void send_packets(int index);
  bool packet_is_due(const Engine& engine) const;
  bool data_of_next_piece_are_there(const Engine& engine) const;
  void begin_phase(int index);
  void begin_phase(int index, Phase phase, Cycles cycles);
  void end_phase(int index, Phase phase);
  bool is_over(const Engine& engine) const;
  void sent(const tlm::tlm_generic_payload& packet);
  Cycles responded(tlm::tlm_generic_payload& packet);
  static bool is_read_of(int engine, const OnTheWay& way) {
    return way.engine == engine && (way.packet == nullptr || way.packet->is_read());
  }
  /// Takes the data of a read; they count when all packets before are there.
  void take_data(OnTheWay& way);
  bool room() const { return on_the_way_.size() < outstanding_packets_; }
  std::vector<OnTheWay>::iterator find(const tlm::tlm_generic_payload& packet);

  EventQueue& event_queue_;
  tlm::tlm_initiator_socket<>& memory_;
  AtInitiator initiator_;
  PayloadPool pool_;
  const PioTiming& timing_;
  MonoWindow& mono_;
  Owner owner_;
  std::uint64_t packet_bytes_;
  std::size_t outstanding_packets_;
  std::array<Engine, 2> engines_;
  std::vector<OnTheWay> on_the_way_;
  std::uint64_t bytes_moved_ = 0;
};

}  // namespace model
