#pragma once

#include <tlm_utils/simple_target_socket.h>
#include <optional>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/config/chip_config.hpp"
#include "model/memory/on_chip_sram_timing.hpp"
#include "model/time/clock_domain.hpp"
#include "model/time/event_queue.hpp"
#include "model/transaction/at_target.hpp"

namespace model {

/// The memory on the chip: an SRAM behind one TLM-2.0 target socket. Reads and writes of any length; no byte
/// enables, no streaming. The delay in is the arrival of the access, the delay out the cycle after its last
/// byte. With an event queue it also speaks the four phases: it takes a request in the cycle in which it
/// comes and begins the response in the cycle after its last byte.
class OnChipSram : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket<OnChipSram> socket{"socket"};

  /// The chip has one: config.on_chip_sram.size_bytes > 0.
  OnChipSram(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
             EventQueue* event_queue = nullptr);

  const OnChipSramStatistics& statistics() const { return timing_.statistics(); }
  void set_observer(OnChipSramObserver* observer) { timing_.set_observer(observer); }
  std::vector<std::uint8_t>& memory() { return memory_; }

 private:
  void b_transport(tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  unsigned int transport_dbg(tlm::tlm_generic_payload& transaction);
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi);
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

  Cycles take(tlm::tlm_generic_payload& transaction);
  /// Moves the data and sets the response. Returns when it is over, `arrival` after an error.
  Cycles serve(tlm::tlm_generic_payload& transaction, Cycles arrival);

  ClockDomain clock_;
  OnChipSramTiming timing_;
  std::vector<std::uint8_t> memory_;
  Cycles dmi_latency_cycles_;
  EventQueue* event_queue_;
  std::optional<AtTarget> at_target_;
};

}  // namespace model
