#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>
#include <memory>
#include <optional>
#include <string>
#include <systemc>
#include <tlm>
#include <vector>

#include "model/config/address_map.hpp"
#include "model/config/chip_config.hpp"
#include "model/network/at_router.hpp"
#include "model/network/booked_traffic.hpp"
#include "model/network/clear_connect_timing.hpp"
#include "model/time/clock_domain.hpp"
#include "model/time/event_queue.hpp"

namespace model {

/// The on-chip network between initiators and the memories of its address map. A read goes out as request
/// packets and comes back as data packets; a write is posted: its data packets go out, nothing comes back,
/// and the delay out says when the memory has taken the last byte. Debug transport and DMI pass through. With
/// an event queue it also passes on transactions in four phases (AtRouter).
///
/// Any TLM-2.0 memory can be bound, to ddr_socket, which answers from mono address 0 on, or by bind(). A
/// memory sees addresses from 0. A transfer lies within the range of one memory; any other gets
/// TLM_ADDRESS_ERROR_RESPONSE and takes no time. PeAddresses are passed on only to the memory at ddr_socket,
/// so for all others a gather is one transaction a run.
class ClearConnect : public sc_core::sc_module {
 public:
  using InitiatorSocket = tlm_utils::simple_target_socket_tagged<ClearConnect>;
  using MemorySocket = tlm_utils::simple_initiator_socket_tagged<ClearConnect>;

  InitiatorSocket pio_socket{"pio_socket"};
  InitiatorSocket control_socket{"control_socket"};
  InitiatorSocket host_socket{"host_socket"};
  MemorySocket ddr_socket{"ddr_socket"};

  BookedTrafficPort booked_traffic{"booked_traffic"};

  ClearConnect(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
               EventQueue* event_queue = nullptr);

  /// Binds a memory, by a target socket of any kind, at further addresses, before the simulation starts.
  /// Throws AddressMapError when the range is empty or overlaps another.
  Port bind(tlm::tlm_base_target_socket_b<>& memory, const std::string& name, const cn::MonoRange& range,
            const PortConfig& config);
  /// Binds an initiator beside the chip's own, with a link of its own, before the simulation starts.
  Initiator bind_initiator(tlm::tlm_base_initiator_socket_b<>& initiator);
  /// Which memory answers where. It grows with bind().
  const AddressMap& map() const { return map_; }

  const ClearConnectStatistics& statistics(Initiator initiator) const {
    return timing_.statistics(initiator);
  }
  void set_observer(PortObserver* observer) { timing_.set_observer(observer); }

 private:
  struct Load {
    Port port;
    bool write;
    std::uint64_t bytes;
    std::uint64_t packets;
  };

  /// A socket that joins when the network's own construction is over: SystemC wants it in a module of its
  /// own.
  template <class Socket>
  struct Joined : sc_core::sc_module {
    Socket socket{"socket"};
    explicit Joined(const sc_core::sc_module_name& name) : sc_module(name) {}
  };
  std::string name_of_joined(const std::string& name) const;
  void register_socket(InitiatorSocket& socket, Initiator initiator);
  void register_socket(MemorySocket& socket, Port port);
  MemorySocket& memory(Port port) { return *memories_[std::size_t(port)]; }
  /// The memory's own address.
  std::uint64_t local(std::uint64_t address, Port port) const { return address - map_[int(port)].mono.first; }
  void pass_on(Port port, tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  void b_transport(int initiator, tlm::tlm_generic_payload& transaction, sc_core::sc_time& delay);
  tlm::tlm_sync_enum nb_transport_fw(int initiator, tlm::tlm_generic_payload& transaction,
                                     tlm::tlm_phase& phase, sc_core::sc_time& delay);
  tlm::tlm_sync_enum nb_transport_bw(int port, tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);
  tlm::tlm_sync_enum answer(int initiator, tlm::tlm_generic_payload& transaction, tlm::tlm_phase& phase,
                            sc_core::sc_time& delay);
  unsigned int transport_dbg(int initiator, tlm::tlm_generic_payload& transaction);
  bool get_direct_mem_ptr(int initiator, tlm::tlm_generic_payload& transaction, tlm::tlm_dmi& dmi);
  void invalidate_direct_mem_ptr(int port, sc_dt::uint64 start, sc_dt::uint64 end);

  void pass_write(Initiator initiator, const Load& load, tlm::tlm_generic_payload& transaction,
                  sc_core::sc_time& delay);
  void pass_read(Initiator initiator, const Load& load, tlm::tlm_generic_payload& transaction,
                 sc_core::sc_time& delay);

  ClockDomain clock_;
  AddressMap map_;
  ClearConnectTiming timing_;
  std::vector<InitiatorSocket*> initiators_;                               ///< by Initiator
  std::vector<MemorySocket*> memories_;                                    ///< by Port
  std::vector<std::unique_ptr<Joined<InitiatorSocket>>> more_initiators_;  ///< bound by bind_initiator()
  std::vector<std::unique_ptr<Joined<MemorySocket>>> more_memories_;       ///< bound by bind()
  std::optional<AtRouter> at_router_;
};

}  // namespace model
