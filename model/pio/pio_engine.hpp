#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <memory>
#include <systemc>
#include <tlm>

#include "firmware/cn/chip/poly_memory.hpp"
#include "model/config/chip_config.hpp"
#include "model/memory/mono_window.hpp"
#include "model/observe/pio_observer.hpp"
#include "model/pio/pio_port.hpp"
#include "model/pio/pio_requests.hpp"
#include "model/pio/pio_service.hpp"
#include "model/pio/pio_timing.hpp"
#include "model/pio/pio_transactions.hpp"
#include "model/time/clock_domain.hpp"

namespace model {

class AtPioService;
class EventQueue;
class FaultInjector;

/// The programmed-I/O engine. Data move when a request is queued; time is booked when it is served: setup and
/// PE side from PioTiming, order from PioQueue, memory side by transactions through `mono_socket`, port use
/// of the SRAMs through `poly_socket`. How a request is served, loosely or approximately timed, is the
/// PioService's business; the engine is approximately timed if it has an event queue.
///
/// A request without an enabled PE (or of no bytes) signals at once and costs nothing here, even when the
/// queue is full.
class PioEngine : public sc_core::sc_module, public PioPort {
 public:
  sc_core::sc_export<PioPort> port{"port"};
  sc_core::sc_port<SemaphorePort> semaphores{"semaphores"};
  /// May stay unbound if no other initiator uses the memory.
  sc_core::sc_port<TimePort, 1, sc_core::SC_ZERO_OR_MORE_BOUND> time{"time"};
  tlm_utils::simple_initiator_socket<PioEngine> mono_socket{"mono_socket"};
  tlm_utils::simple_initiator_socket<PioEngine> poly_socket{"poly_socket"};

  PioEngine(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
            cn::PolyMemory& poly, EventQueue* event_queue = nullptr);
  ~PioEngine() override;

  /// Throws cn::MachineFault when an enabled PE's piece is not within mono memory; nothing has moved then.
  Cycles enqueue(const cn::Transfer& transfer, Cycles now) override;
  void settle(Cycles now) override { service_->settle(now); }
  bool serve_next() override { return service_->serve_next(); }
  std::optional<Cycles> next_start() const override { return service_->next_start(); }
  /// Loosely timed, only the latest requests are remembered, at least as many as the queue holds; words of
  /// older ones count as moved.
  std::uint64_t words_moved_before(Cycles cycle) const override {
    return service_->words_moved_before(cycle);
  }

  /// Mono memory is what `map` says, which lives as long as the engine; without it, the chip's own memories.
  void follow(const AddressMap& map) { mono_.follow(map); }
  void set_observer(PioObserver* observer) { requests_.set_observer(observer); }
  /// Breaks the signals of finished requests; may be null, otherwise lives as long as the engine.
  void set_faults(FaultInjector* faults) { faults_ = faults; }
  /// From now on requests take their time but move no data: for firmware that looks at none.
  void leave_data(bool leave) { leaves_data_ = leave; }
  const PioStatistics& statistics() const { return requests_.statistics(); }
  int queue_depth() const { return requests_.waiting(); }

 private:
  void signal(int semaphore, Cycles at);
  /// Lets the service make room; returns when there is some.
  Cycles wait_for_room(cn::Direction direction, Cycles now);
  void describe(const cn::Transfer& transfer, PioRequest& request);
  void move_data(const cn::Transfer& transfer, const PioRequest& request);

  void forget_mono_pointer(sc_dt::uint64 start, sc_dt::uint64 end);
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& packet, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

  cn::PolyMemory& poly_;
  MonoPieces::Rules rules_;
  PioTiming timing_;
  MonoWindow mono_;
  PioRequests requests_;
  PioTransactions transactions_;
  std::unique_ptr<PioService> service_;
  AtPioService* at_service_ = nullptr;  ///< whom nb_transport_bw concerns; approximately timed only
  bool leaves_data_ = false;
  FaultInjector* faults_ = nullptr;
};

}  // namespace model
