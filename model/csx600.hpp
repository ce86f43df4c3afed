#pragma once

#include <cstdint>
#include <memory>
#include <systemc>
#include <vector>

#include "model/config/chip_config.hpp"
#include "model/config/timing_style.hpp"
#include "model/faults/fault_injector.hpp"
#include "model/host_link/host_link.hpp"
#include "model/memory/mono_ddr.hpp"
#include "model/memory/on_chip_sram.hpp"
#include "model/mtap_array.hpp"
#include "model/network/bridge.hpp"
#include "model/network/clear_connect.hpp"
#include "model/search_unit/search_unit.hpp"
#include "model/time/clock_domain.hpp"

namespace model {

/// What stands for mono memory.
enum class MonoMemory : std::uint8_t {
  ddr,            ///< MonoDdr
  bound_outside,  ///< any TLM-2.0 target of ddr.size_bytes, bound to clear_connect.ddr_socket before the run
};

/// One ClearSpeed CSX600 with its DDR2 and its link to the host. Memories of others join the address map by
/// clear_connect.bind().
///
///   control_unit --port--> pio_engine --+
///        |                     |        +--> clear_connect --> mono_ddr
///     pe_array <-- poly_sram <-+        |                +---> on_chip_sram, search_unit
///        control_unit (data cache) -----+
///        host_link, search_unit --------+
///
/// A CSX700 is the same with two arrays (chip.arrays), each with a control unit, PEs and a PIO engine of its
/// own, that share network, memories and host link. Each array runs firmware of its own.
class Csx600 : public sc_core::sc_module {
 public:
  explicit Csx600(const sc_core::sc_module_name& name, const ChipConfig& config,
                  TimingStyle timing = TimingStyle::loosely_timed, MonoMemory memory = MonoMemory::ddr);

 private:
  ChipConfig config_;

 public:
  const ClockDomain clock;
  const std::unique_ptr<EventQueue> event_queue;  ///< null when loosely timed

 private:
  std::vector<std::unique_ptr<EventQueue>> event_queues_of_arrays_;  ///< of all arrays but the first
  std::vector<std::unique_ptr<MtapArray>> arrays_;

 public:
  // Those of the first array:
  PeArray& pe_array;
  ControlUnit& control_unit;
  PolySram& poly_sram;
  PioEngine& pio_engine;
  ClearConnect clear_connect;
  const std::unique_ptr<MonoDdr> mono_ddr;         ///< null if the memory is bound outside
  const std::unique_ptr<OnChipSram> on_chip_sram;  ///< null if the chip has none
  const std::unique_ptr<SearchUnit> search_unit;   ///< likewise
  HostLink host_link;

  const ChipConfig& config() const { return config_; }
  /// Others than this chip may use its mono memory (ControlUnit::share_memory()).
  void share_memory();
  /// Breaks this chip, which has one array and a DDR of its own. To be called before the run, once.
  void inject(std::vector<Fault> faults);
  /// All zero for a chip without faults.
  FaultCounts fault_counts() const { return faults_ ? faults_->counts() : FaultCounts{}; }
  /// After the run: throws cn::MachineFault if faults were found that cannot be corrected.
  void require_no_detected_fault() const {
    if (faults_) faults_->throw_if_detected();
  }
  int arrays() const { return static_cast<int>(arrays_.size()); }
  MtapArray& array(int number) { return *arrays_.at(std::size_t(number)); }
  const MtapArray& array(int number) const { return *arrays_.at(std::size_t(number)); }
  /// All zero if the memory is bound outside.
  DdrStatistics ddr_statistics() const { return mono_ddr ? mono_ddr->statistics() : DdrStatistics{}; }
  /// All zero if the chip has none.
  OnChipSramStatistics on_chip_sram_statistics() const {
    return on_chip_sram ? on_chip_sram->statistics() : OnChipSramStatistics{};
  }
  SearchStatistics search_statistics() const {
    return search_unit ? search_unit->statistics() : SearchStatistics{};
  }
  /// Of the search unit's lines; all zero if the chip has none.
  ClearConnectStatistics search_unit_traffic() const {
    return search_unit ? clear_connect.statistics(search_initiator_) : ClearConnectStatistics{};
  }

 private:
  std::vector<std::unique_ptr<MtapArray>> built_arrays();
  void join(MtapArray& array);
  void join_search_unit();

  std::unique_ptr<FaultInjector> faults_;
  Initiator search_initiator_ = Initiator::host;  ///< the search unit at the network
};

/// Lets the arrays of `near` reach the DDR of `far` from mono address `first` on, over a bridge of near's
/// board parameters. To be called before the run; both chips have one timing style. Firmware of both then
/// waits for SystemC time before each access (ControlUnit::share_memory()). The bridge lives as long as they.
/// Throws AddressMapError if near has another memory there.
std::unique_ptr<Bridge> join_by_bridge(Csx600& near, Csx600& far, cn::MonoAddress first);

}  // namespace model
