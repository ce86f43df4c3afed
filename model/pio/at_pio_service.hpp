#pragma once

#include <array>
#include <exception>
#include <systemc>
#include <tlm>

#include "model/pio/pio_packets.hpp"
#include "model/pio/pio_service.hpp"
#include "model/pio/pio_transactions.hpp"
#include "model/time/event_queue.hpp"

namespace model {

/// Serves requests approximately timed: they start, are served packet by packet (PioPackets) and end in
/// SystemC time. The calls of the firmware's process let time pass up to the cycle that they are given.
class AtPioService : public PioService {
 public:
  AtPioService(EventQueue& event_queue, tlm::tlm_initiator_socket<>& memory, const ChipConfig& config,
               const PioTiming& timing, MonoWindow& mono, PioRequests& requests,
               PioTransactions& transactions);

  void settle(Cycles now) override;
  /// Returns when a request has started or is over; false when none is in service.
  bool serve_next() override;
  /// None: requests start by themselves.
  std::optional<Cycles> next_start() const override { return std::nullopt; }
  std::uint64_t words_moved_before(Cycles) const override { return packets_.words_moved(); }
  Cycles make_room() override;
  void mono_changed() override { packets_.refresh_writes_on_the_way(); }

  /// Passes on what the memory side's socket receives.
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return packets_.nb_transport_bw(packet, phase, delay);
  }

 private:
  void start(const PioQueue::Start& next) override;
  void finish(int engine);
  void fail(const tlm::tlm_generic_payload& packet);
  void wait_for_progress();

  EventQueue& event_queue_;
  const PioTiming& timing_;
  PioTransactions& transactions_;
  PioPackets packets_;
  std::array<PioRequest*, 2> in_service_{};  ///< by engine
  sc_core::sc_event progress_;               ///< a request has started or is over
  std::exception_ptr failure_;
};

}  // namespace model
