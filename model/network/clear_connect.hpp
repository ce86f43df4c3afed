#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>
#include <optional>
#include <systemc>
#include <tlm>

#include "model/config/chip_config.hpp"
#include "model/network/at_router.hpp"
#include "model/network/clear_connect_timing.hpp"
#include "model/network/host_traffic.hpp"
#include "model/time/clock_domain.hpp"
#include "model/time/event_queue.hpp"

namespace model {

/// The on-chip network between three initiators and mono memory. A read goes out as request packets and comes
/// back as data packets; a write is posted: its data packets go out, nothing comes back, and the delay out
/// says when the memory has taken the last byte. Debug transport and DMI pass through. Any TLM-2.0 memory can
/// be bound to ddr_socket. With an event queue it also passes on transactions in four phases (AtRouter).
class ClearConnect : public sc_core::sc_module {
 public:
  tlm_utils::simple_target_socket_tagged<ClearConnect> pio_socket{"pio_socket"};
  tlm_utils::simple_target_socket_tagged<ClearConnect> control_socket{"control_socket"};
  tlm_utils::simple_target_socket_tagged<ClearConnect> host_socket{"host_socket"};
  tlm_utils::simple_initiator_socket<ClearConnect> ddr_socket{"ddr_socket"};

  HostTrafficPort host_traffic{"host_traffic"};

  ClearConnect(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
               EventQueue* event_queue = nullptr);

  const ClearConnectStatistics& statistics(Initiator initiator) const {
    return timing_.statistics(initiator);
  }
  void set_observer(PortObserver* observer) { timing_.set_observer(observer); }

 private:
  struct Load {
    bool write;
    std::uint64_t bytes;
    std::uint64_t packets;
  };

  void register_socket(tlm_utils::simple_target_socket_tagged<ClearConnect>& socket, Initiator initiator);
  void b_transport(int initiator, tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  tlm::tlm_sync_enum nb_transport_fw(int initiator, tlm::tlm_generic_payload& transaction,
                                     tlm::tlm_phase& phase, sc_core::sc_time& delay);
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);
  tlm::tlm_sync_enum answer(int initiator, tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                            sc_core::sc_time& delay);
  unsigned int transport_dbg(int initiator, tlm::tlm_generic_payload& transaction);
  bool get_direct_mem_ptr(int initiator, tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi);
  void invalidate_direct_mem_ptr(sc_dt::uint64 start, sc_dt::uint64 end);

  void pass_write(Initiator initiator, const Load& load, tlm::tlm_generic_payload& transaction,
                  sc_core::sc_time& delay);
  void pass_read(Initiator initiator, const Load& load, tlm::tlm_generic_payload& transaction,
                 sc_core::sc_time& delay);

  ClockDomain clock_;
  Divisor port_bytes_per_cycle_;
  ClearConnectTiming timing_;
  std::optional<AtRouter> at_router_;
};

}  // namespace model
