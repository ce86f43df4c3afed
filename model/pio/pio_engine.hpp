#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <exception>
#include <memory>
#include <systemc>
#include <tlm>
#include <vector>

#include "firmware/cn/chip/poly_memory.hpp"
#include "model/config/chip_config.hpp"
#include "model/memory/mono_window.hpp"
#include "model/observe/pio_observer.hpp"
#include "model/pio/at_pio.hpp"
#include "model/pio/pio_port.hpp"
#include "model/pio/pio_queue.hpp"
#include "model/pio/pio_timing.hpp"
#include "model/pio/word_history.hpp"
#include "model/time/clock_domain.hpp"
#include "model/transaction/pe_addresses.hpp"

namespace model {

/// What a fault says of a transaction that memory has answered with an error.
std::string refused_by_memory(const tlm::tlm_generic_payload& transaction);

/// The programmed-I/O engine. Data move when a request is queued; time is booked when it is served: setup and
/// PE side from PioTiming, order from PioQueue, memory side by one transaction with PeAddresses through
/// `mono_socket` (or, if the memory does not know the extension, by one read or write a run), port use of the
/// SRAMs through `poly_socket`.
///
/// Loosely timed, without processes: the control unit calls it with absolute cycles that do not go back. It
/// must settle(t) before it lets SystemC time advance to t, since TLM-2.0 delays cannot point to the past.
///
/// With an event queue it is approximately timed: AtPio serves requests packet by packet in SystemC time, and
/// the port's calls let time pass up to the cycle that they are given.
///
/// A request without an enabled PE (or of no bytes) signals at once and costs nothing here, even when the
/// queue is full.
class PioEngine : public sc_core::sc_module, public PioPort {
 public:
  sc_core::sc_export<PioPort> port{"port"};
  sc_core::sc_port<SemaphorePort> semaphores{"semaphores"};
  tlm_utils::simple_initiator_socket<PioEngine> mono_socket{"mono_socket"};
  tlm_utils::simple_initiator_socket<PioEngine> poly_socket{"poly_socket"};

  PioEngine(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
            cn::PolyMemory& poly, EventQueue* event_queue = nullptr);

  /// Throws cn::MachineFault when an enabled PE's piece is not within mono memory; nothing has moved then.
  Cycles enqueue(const cn::Transfer& transfer, Cycles now) override;
  void settle(Cycles now) override;
  bool serve_next() override;
  std::optional<Cycles> next_start() const override;
  /// Remembers the latest requests only, at least as many as the queue holds; words of older ones count as
  /// moved.
  std::uint64_t words_moved_before(Cycles cycle) const override;

  void set_observer(PioObserver* observer) { observer_ = observer; }
  /// From now on requests take their time but move nothing: for firmware that looks at no data.
  void leave_data(bool leave) { leaves_data_ = leave; }
  const PioStatistics& statistics() const { return statistics_; }
  int queue_depth() const { return queue_.waiting(); }

 private:
  enum class Answer : std::uint8_t { not_asked, yes, no };
  struct Request {
    std::uint64_t id = 0;
    cn::PolySpan poly;
    cn::Semaphore done;
    PeAddresses addresses;
    PioEvent event;
    cn::Label label;
    cn::LaneMask enabled;  ///< kept for an observer only
  };

  void start_due(Cycles now);
  void start(const PioQueue::Start& next);
  void note_start(Request& request, const PioQueue::Start& next);
  void end_request(Request& request, Cycles finish);
  /// Returns when a queued request has started.
  Cycles make_room();
  void signal(cn::Semaphore done, Cycles at);
  void count(const PioEvent& event, Cycles pe_cycles);

  /// Returns when the memory side that begins at `start` is over.
  Cycles book_memory(Request& request, Cycles start);
  /// Whether the memory knows PeAddresses.
  bool ask_memory();
  sc_core::sc_time book_runs(const MonoPieces& pieces, const sc_core::sc_time& delay);
  void book_poly(Request& request, Cycles data_start);
  void send_addresses(tlm_utils::simple_initiator_socket<PioEngine>& socket, PeAddresses& addresses,
                      std::uint64_t address, sc_core::sc_time& delay);
  void prepare(tlm::tlm_command command, std::uint64_t address, std::uint64_t bytes);

  // Approximately timed (pio_engine_at.cpp):
  void build_at(EventQueue& event_queue, const ChipConfig& config);
  void start_at(const PioQueue::Start& next);
  void finish_at(int engine);
  void fail(const tlm::tlm_generic_payload& packet);
  void pass_time_until(Cycles cycle);
  bool wait_for_request();
  void wait_for_progress();
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

  void forget_mono_pointer(sc_dt::uint64 start, sc_dt::uint64 end);

  ClockDomain clock_;
  cn::PolyMemory& poly_;
  MonoPieces::Rules rules_;
  PioTiming timing_;
  PioQueue queue_;
  MonoWindow mono_;
  std::vector<Request> requests_;  ///< pool: storage of addresses is kept
  std::vector<int> free_slots_;
  std::vector<WordHistory> history_;  ///< by engine
  std::uint64_t next_id_ = 0;

  Answer memory_serves_ = Answer::not_asked;  ///< PeAddresses
  tlm::tlm_generic_payload transaction_;
  std::vector<std::uint8_t> run_data_;

  EventQueue* event_queue_ = nullptr;
  std::unique_ptr<AtPio> at_;
  std::array<Request*, 2> in_service_{};  ///< by engine
  sc_core::sc_event progress_;            ///< a request has started or is over
  std::exception_ptr failure_;

  bool leaves_data_ = false;
  PioObserver* observer_ = nullptr;
  PioStatistics statistics_;
};

}  // namespace model
