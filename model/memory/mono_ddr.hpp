#pragma once

#include <tlm_utils/simple_target_socket.h>
#include <optional>
#include <systemc>
#include <tlm>

#include "model/config/chip_config.hpp"
#include "model/memory/ddr_timing.hpp"
#include "model/memory/lazy_memory.hpp"
#include "model/time/clock_domain.hpp"
#include "model/time/event_queue.hpp"
#include "model/transaction/at_target.hpp"
#include "model/transaction/pe_addresses.hpp"

namespace model {

class FaultInjector;

/// Mono memory: DDR2 behind one TLM-2.0 target socket. Reads and writes of any length; no byte enables, no
/// streaming. The delay in is the arrival of the access, the delay out the cycle after its last byte
/// (DdrTiming).
///
/// A transaction with PeAddresses costs exactly what one transaction a run would, all sent with the same
/// delay: the runs are booked one after the other from one arrival. The delay out is the end of the last.
///
/// With an event queue it also speaks the four phases: it takes up to ddr.queue_transactions, ends the
/// request of the last one when another is over, and begins the response of each in the cycle after its last
/// byte.
class MonoDdr : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<MonoDdr> socket{"socket"};

  MonoDdr(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
          EventQueue* event_queue = nullptr);

  const DdrStatistics& statistics() const { return timing_.statistics(); }
  void set_observer(DdrObserver* observer, bool with_commands) {
    timing_.set_observer(observer, with_commands);
  }
  /// Is told of every access; may be null, otherwise lives as long as the memory.
  void set_faults(FaultInjector* faults) { faults_ = faults; }
  LazyMemory& memory() { return memory_; }

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  unsigned int transport_dbg(tlm::tlm_generic_payload& transaction);
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi);

  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

  std::optional<Cycles> take(tlm::tlm_generic_payload& transaction);
  void finish(tlm::tlm_generic_payload& transaction);
  /// Sets `finish` if the response is OK.
  tlm::tlm_response_status access_plainly(const tlm::tlm_generic_payload& transaction, Cycles arrival,
                                          Cycles& finish);
  tlm::tlm_response_status serve(PeAddresses& addresses, sc_core::sc_time& delay);

  ClockDomain clock_;
  DdrTiming timing_;
  LazyMemory memory_;
  Cycles dmi_latency_cycles_;

  FaultInjector* faults_ = nullptr;

  EventQueue* event_queue_;
  std::optional<AtTarget> at_target_;
  int queue_transactions_;
  int queued_ = 0;
  tlm::tlm_generic_payload* not_accepted_ =
      nullptr;  ///< the one that filled the queue: its request has not ended
};

}  // namespace model
