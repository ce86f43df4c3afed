#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <systemc>
#include <tlm>
#include <vector>

#include "firmware/cn/poly_memory.hpp"
#include "model/chip_config.hpp"
#include "model/clock_domain.hpp"
#include "model/mono_window.hpp"
#include "model/pe_addresses.hpp"
#include "model/pio_observer.hpp"
#include "model/pio_port.hpp"
#include "model/pio_queue.hpp"
#include "model/pio_timing.hpp"
#include "model/word_history.hpp"

namespace model {

/// The programmed-I/O engine. Data move when a request is queued; time is booked when it is served: setup and
/// PE side from PioTiming, order from PioQueue, memory side by one transaction with PeAddresses through
/// `mono_socket` (or, if the memory does not know the extension, by one read or write a run), port use of the
/// SRAMs through `poly_socket`.
///
/// Without processes: the control unit calls it with absolute cycles that do not go back. It must settle(t)
/// before it lets SystemC time advance to t, since TLM-2.0 delays cannot point to the past.
///
/// A request without an enabled PE (or of no bytes) signals at once and costs nothing here, even when the
/// queue is full.
class DmaEngine : public sc_core::sc_module, public PioPort {
 public:
  sc_core::sc_export<PioPort> port{"port"};
  sc_core::sc_port<SemaphorePort> semaphores{"semaphores"};
  tlm_utils::simple_initiator_socket<DmaEngine> mono_socket{"mono_socket"};
  tlm_utils::simple_initiator_socket<DmaEngine> poly_socket{"poly_socket"};

  DmaEngine(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
            cn::PolyMemory& poly);

  /// Throws cn::MachineFault when an enabled PE's piece is not within mono memory; nothing has moved then.
  Cycles enqueue(const cn::Transfer& transfer, Cycles now) override;
  void settle(Cycles now) override;
  bool serve_next() override;
  std::optional<Cycles> next_start() const override;
  /// Remembers the latest requests only, at least as many as the queue holds; words of older ones count as
  /// moved.
  std::uint64_t words_moved_before(Cycles cycle) const override;

  void set_observer(PioObserver* observer) { observer_ = observer; }
  const PioStatistics& statistics() const { return statistics_; }
  int queue_depth() const { return queue_.waiting(); }

 private:
  enum class Answer : std::uint8_t { not_asked, yes, no };
  struct Request {
    std::uint64_t id = 0;
    cn::PolySpan poly;
    cn::Semaphore done;
    PeAddresses addresses;
  };

  void start(const PioQueue::Start& next);
  void signal(cn::Semaphore done, Cycles at);
  void count(const PioEvent& event, Cycles pe_cycles);

  /// Returns when the memory side that begins at `start` is over.
  Cycles book_memory(Request& request, Cycles start);
  /// Whether the memory knows PeAddresses.
  bool ask_memory();
  sc_core::sc_time book_runs(const MonoPieces& pieces, const sc_core::sc_time& delay);
  void book_poly(Request& request, Cycles data_start);
  void send_addresses(tlm_utils::simple_initiator_socket<DmaEngine>& socket, PeAddresses& addresses,
                      std::uint64_t address, sc_core::sc_time& delay);
  void prepare(tlm::tlm_command command, std::uint64_t address, std::uint64_t bytes);
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

  PioObserver* observer_ = nullptr;
  PioStatistics statistics_;
};

}  // namespace model
