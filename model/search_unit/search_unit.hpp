#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>
#include <memory>
#include <optional>
#include <systemc>
#include <tlm>
#include <vector>

#include "firmware/cn/chip/search_buffer.hpp"
#include "model/config/chip_config.hpp"
#include "model/network/booked_traffic.hpp"
#include "model/search_unit/search_timing.hpp"
#include "model/time/clock_domain.hpp"
#include "model/time/event_queue.hpp"
#include "model/transaction/at_initiator.hpp"
#include "model/transaction/at_target.hpp"
#include "model/transaction/divisor.hpp"
#include "model/transaction/payload_pool.hpp"

namespace model {

/// A search unit on the chip's network: its buffer behind a TLM-2.0 target socket, its lines of mono memory
/// fetched through an initiator socket. A write that completes queries starts them; a read of answers ends
/// when the last of them is found. Debug transport reads and writes without time; there is no direct pointer.
///
/// Loosely timed, steps are booked as others on the network come that far (BookedTraffic), and to the end of
/// what a read waits for. Approximately timed, they are tasks of the event queue.
class SearchUnit : public sc_core::sc_module, public BookedTraffic {
 public:
  tlm_utils::simple_target_socket<SearchUnit> socket{"socket"};
  tlm_utils::simple_initiator_socket<SearchUnit> mono_socket{"mono_socket"};
  sc_core::sc_export<BookedTraffic> traffic{"traffic"};

  /// The chip has one: config.search_unit.units > 0.
  SearchUnit(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
             EventQueue* event_queue = nullptr);

  void program(std::shared_ptr<cn::SearchFunction> function);

  SearchStatistics statistics() const;
  void set_observer(SearchObserver* observer) { timing_.set_observer(observer); }

  void book_until(Cycles cycle) override;
  bool in_progress() const override { return false; }

 private:
  /// A read that waits for answers.
  struct Reader {
    tlm::tlm_generic_payload* transaction;
    cn::SearchBuffer::Entries entries;
    Cycles arrival;
  };

  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);
  unsigned int transport_dbg(tlm::tlm_generic_payload& transaction);
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi);
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

  /// Whether the transaction is a read or write within the buffer; sets the response.
  bool accept(tlm::tlm_generic_payload& transaction) const;
  /// The port moves the bytes from `ready` on. Returns when it has.
  Cycles move(tlm::tlm_generic_payload& transaction, Cycles ready);
  Cycles write(tlm::tlm_generic_payload& transaction, Cycles arrival);
  void start(int entry, Cycles at);
  void take_answer(int entry, Cycles at);
  bool are_found(const cn::SearchBuffer::Entries& entries) const;
  Cycles found_at(const cn::SearchBuffer::Entries& entries) const;
  void fetch(int unit, cn::MonoAddress first, Cycles at);
  void read_mono(cn::MonoAddress from, void* to, std::size_t bytes);

  // Approximately timed:
  Cycles take(tlm::tlm_generic_payload& transaction);
  void respond(tlm::tlm_generic_payload& transaction, Cycles at);
  void send_line(int unit, cn::MonoAddress first);
  Cycles take_line(tlm::tlm_generic_payload& packet);
  void work();
  void work_later();

  ClockDomain clock_;
  Divisor bytes_per_cycle_;
  std::uint64_t line_bytes_;
  cn::SearchBuffer buffer_;
  SearchTiming timing_;
  cn::SearchFunction::Read read_;
  Cycles port_free_ = 0;
  int first_search_ = 0;          ///< number of the first entry's searches, by which programs are told apart
  std::vector<int> searches_;     ///< under way, of each entry
  std::vector<Cycles> answered_;  ///< when the latest was over
  SearchStatistics statistics_;   ///< of the buffer
  bool booking_ = false;
  tlm::tlm_generic_payload line_;
  std::vector<std::uint8_t> line_data_;

  EventQueue* event_queue_;
  std::optional<AtTarget> at_target_;
  std::optional<AtInitiator> at_initiator_;
  PayloadPool pool_;
  struct OnTheWay {
    tlm::tlm_generic_payload* packet;
    cn::MonoAddress first;
    int unit;
  };
  std::vector<OnTheWay> on_the_way_;
  std::vector<Reader> readers_;
  std::optional<Cycles> works_at_;  ///< when work() is scheduled
};

}  // namespace model
