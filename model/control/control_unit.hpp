#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <functional>
#include <string>
#include <systemc>
#include <tlm>

#include "firmware/cn/machine.hpp"
#include "model/config/chip_config.hpp"
#include "model/control/control_statistics.hpp"
#include "model/control/cycle_ledger.hpp"
#include "model/control/hardware_threads.hpp"
#include "model/control/host_semaphore_port.hpp"
#include "model/control/mono_access.hpp"
#include "model/control/semaphores.hpp"
#include "model/control/time_coupling.hpp"
#include "model/network/booked_traffic.hpp"
#include "model/observe/control_observer.hpp"
#include "model/pe_array/pe_array.hpp"
#include "model/pio/pio_port.hpp"
#include "model/search_unit/search_unit.hpp"
#include "model/time/clock_domain.hpp"
#include "model/time/event_queue.hpp"

namespace model {

class FaultInjector;

/// Runs firmware: the chip's one instruction stream. The firmware's C++ executes at once on a SystemC process
/// and runs ahead by a local cycle count; it synchronises with SystemC time where the host can see it
/// (semaphores shared with the host, the end) and wherever an observer asks for it. With an event queue it is
/// approximately timed: the PIO port lets time pass at each request, semaphore wait and kernel end, and mono
/// accesses are transactions of four phases.
///
/// This module translates the firmware's calls into what its parts do: CycleLedger counts the cycles,
/// TimeCoupling keeps PIO engine and SystemC time in step, Semaphores and HostSemaphorePort hold the signals,
/// HardwareThreads has the threads, MonoAccess the data cache.
///
/// Further hardware threads (loosely timed only) share the stream and its cycle count. What makes the control
/// unit itself stand still, a full PIO queue or a data cache miss, stops all threads.
class ControlUnit : public sc_core::sc_module, public cn::Machine, public SemaphorePort, public TimePort {
 public:
  sc_core::sc_port<PioPort> pio{"pio"};
  sc_core::sc_export<SemaphorePort> semaphores{"semaphores"};
  sc_core::sc_export<TimePort> time{"time"};
  tlm_utils::simple_initiator_socket<ControlUnit> mono_socket{"mono_socket"};
  BookedTrafficPort booked_traffic{"booked_traffic"};

  using Firmware = std::function<void(cn::Machine&)>;

  ControlUnit(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
              PeArray& pe_array, EventQueue* event_queue = nullptr);

  /// What runs from `start()` on.
  void load(Firmware firmware) { firmware_ = std::move(firmware); }
  /// Called by the host: the firmware begins at the present SystemC time. It may be started again, or another
  /// one loaded and started, when it has come to its end: poly buffers, semaphores, data cache and statistics
  /// of the control unit begin anew; memories and the statistics of other units go on. Throws
  /// std::logic_error while it runs, or after it has failed.
  void start();
  bool finished() const { return threads_.finished(); }
  const sc_core::sc_event& finished_event() const { return threads_.finished_event(); }
  /// Throws what the firmware threw, if it did.
  void rethrow_failure() const { threads_.rethrow_failure(); }
  /// Once SystemC has no events left: throws what the firmware threw, or cn::MachineFault with the wait graph
  /// if it has not come to its end.
  void require_finished() const;

  /// The host's side of the semaphores that it shares with the firmware.
  HostSemaphorePort& host_semaphores() { return host_semaphores_; }

  /// The firmware's cycle, at or ahead of SystemC's time.
  Cycles now() const { return ledger_.now(); }
  /// When the firmware began.
  Cycles start_cycle() const { return ledger_.start_cycle(); }
  const ControlStatistics& statistics() const { return ledger_.statistics(); }

  /// Others than this chip may use its mono memory, so the firmware must not run ahead of them
  /// (TimeCoupling::approach).
  void share_memory() { time_.share_memory(); }

  /// Reports spans to `observer`; synchronises at least every `sync_cycles` so that they can be shown in
  /// time.
  void set_observer(ControlObserver* observer, Cycles sync_cycles) {
    ledger_.set_observer(observer, sync_cycles);
  }

  /// Mono memory is what `map` says, which lives as long as the control unit; without it, the chip's own
  /// memories.
  void follow(const AddressMap& map) { mono_access_.follow(map); }

  /// Breaks what runs on this control unit; may be null, otherwise lives as long as it.
  void set_faults(FaultInjector* faults) { faults_ = faults; }

  /// Firmware may program this unit, which lives as long as the control unit.
  void join(SearchUnit& unit) { search_unit_ = &unit; }

  // cn::Machine:
  void sem_signal(cn::Semaphore semaphore) override;
  void sem_wait(cn::Semaphore semaphore) override;
  void issue_mono(std::uint64_t instructions) override;
  void timed(bool on) override;
  void start_thread(int priority, const std::string& name, std::function<void()> body) override;
  cn::MonoRange scratchpad() const override { return on_chip_sram_range(config_); }
  cn::MonoRange search_unit() const override { return search_unit_range(config_); }
  void program_search_unit(std::shared_ptr<cn::SearchFunction> function) override;
  void report_fill(int block, const cn::LaneMask& slots) override;

  // SemaphorePort:
  void signal_at(int index, Cycles at) override { semaphores_.signal(index, Signaller::pio, at); }
  // TimePort:
  void approach(Cycles cycle) override { time_.approach(cycle); }

 protected:
  void retire(const char* kernel, const cn::IssueTree& issued) override;
  void start_transfer(const cn::Transfer& transfer) override;
  const void* read_mono_bytes(cn::MonoAddress from, std::size_t bytes) override;
  void write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) override;

 private:
  void run();
  void begin_again();
  /// After each operation that took time: what is broken breaks, and firmware that runs for ever ends.
  void time_passed();
  void report_kernel_begin(const char* kernel, const cn::IssueTree& issued);
  void report_kernel_end(const char* kernel, const cn::IssueTree& issued, Cycles start);
  void forget_mono_pointer(sc_dt::uint64, sc_dt::uint64) { mono_access_.forget_pointer(); }
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) {
    return mono_access_.nb_transport_bw(payload, phase, delay);
  }

  const ChipConfig& config_;
  SearchUnit* search_unit_ = nullptr;
  FaultInjector* faults_ = nullptr;
  const bool approximately_timed_;
  PeArray& pe_array_;
  CycleLedger ledger_;
  TimeCoupling time_;
  Semaphores semaphores_;
  HostSemaphorePort host_semaphores_;
  HardwareThreads threads_;
  MonoAccess mono_access_;

  Firmware firmware_;
  bool timed_ = true;
  bool start_asked_ = false;       ///< and the firmware has not begun yet
  bool firmware_started_ = false;  ///< at least once
  sc_core::sc_event start_event_;
};

}  // namespace model
