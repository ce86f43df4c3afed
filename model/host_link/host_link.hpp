#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <memory>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/config/chip_config.hpp"
#include "model/host_link/host_link_statistics.hpp"
#include "model/host_link/host_packets.hpp"
#include "model/network/booked_traffic.hpp"
#include "model/observe/memory_observer.hpp"
#include "model/transaction/at_initiator.hpp"
#include "model/transaction/payload_pool.hpp"

namespace model {

/// PCI-X or PCIe between host memory and mono memory (HostLinkTiming). Data move at once, by debug transport;
/// their packets contend on the chip's network with those of the PIO engine and the control unit.
///
/// Loosely timed: a transfer's end is that of the link itself, since the link is far narrower than the
/// network; its packets only hold up others (BookedTraffic). Approximately timed, with an event queue: the
/// calling process waits, and the transfer ends with the link or with the memory's last response, whichever
/// is later.
class HostLink : public sc_core::sc_module, public BookedTraffic {
 public:
  static constexpr std::uint64_t kMaxDmaBytes = HostLinkTiming::kMaxDmaBytes;
  /// Packets that may be between the link's bridge and the memory at a time (assumed); approximately timed
  /// only.
  static constexpr std::size_t kOutstandingPackets = 16;

  tlm_utils::simple_initiator_socket<HostLink> socket{"socket"};
  sc_core::sc_export<BookedTraffic> traffic{"traffic"};

  HostLink(const sc_core::sc_module_name& name, const ChipConfig& config, EventQueue* event_queue = nullptr);

  /// Several chips of one clock behind one link, as on the board: from now on transfers of this and of
  /// `other` take turns on it, in the order of the calls. To be called before the run.
  void share_link_of(const HostLink& other) { link_free_ = other.link_free_; }
  /// The chip is behind so many bridges of the board; to be called once, before the run.
  void cross_bridges(int bridges) { timing_.cross_bridges(bridges, board_); }

  /// Returns the cycle at which the last byte is there; the caller waits. Throws std::out_of_range when mono
  /// memory does not take all bytes.
  Cycles upload(cn::MonoAddress to, const void* from, std::uint64_t bytes, Cycles now);
  Cycles download(cn::MonoAddress from, void* to, std::uint64_t bytes, Cycles now);

  void book_until(Cycles cycle) override;
  bool in_progress() const override;

  const HostLinkStatistics& statistics() const { return statistics_; }
  void set_observer(HostObserver* observer) { observer_ = observer; }

 private:
  Cycles transfer(tlm::tlm_command command, cn::MonoAddress address, unsigned char* data, std::uint64_t bytes,
                  Cycles now);
  /// False when mono memory does not take all bytes.
  bool move(tlm::tlm_command command, cn::MonoAddress address, unsigned char* data, std::uint64_t bytes);
  void book(const HostPackets& packets);
  tlm::tlm_generic_payload& take_packet(const HostPackets& packets);

  // Approximately timed:
  Cycles wait_for_packets(HostPackets& packets, Cycles link_end);
  void send_due();
  Cycles take_response(tlm::tlm_generic_payload& packet);
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

  ClockDomain clock_;
  ChipConfig::Board board_;
  HostLinkTiming timing_;
  std::shared_ptr<Cycles> link_free_ = std::make_shared<Cycles>(0);  ///< of all chips behind the link
  sc_core::sc_time free_at_;  ///< when the latest transfer of this chip is over
  PayloadPool pool_;
  std::vector<HostPackets> unbooked_;  ///< transfers whose packets are not all booked yet, in order

  EventQueue* event_queue_;
  std::unique_ptr<AtInitiator> at_initiator_;
  HostPackets* sending_ = nullptr;
  std::size_t on_the_way_ = 0;
  bool send_asked_ = false;
  sc_core::sc_event answered_;

  HostObserver* observer_ = nullptr;
  HostLinkStatistics statistics_;
};

}  // namespace model
