#pragma once

#include <tlm_utils/simple_initiator_socket.h>
#include <array>
#include <exception>
#include <functional>
#include <memory>
#include <systemc>
#include <tlm>

#include "firmware/cn/machine.hpp"
#include "model/config/chip_config.hpp"
#include "model/control/control_statistics.hpp"
#include "model/control/data_cache.hpp"
#include "model/control/semaphore_file.hpp"
#include "model/control/thread_scheduler.hpp"
#include "model/control/wait_record.hpp"
#include "model/memory/mono_window.hpp"
#include "model/network/host_traffic.hpp"
#include "model/observe/control_observer.hpp"
#include "model/pe_array/pe_array.hpp"
#include "model/pe_array/stolen_cycles.hpp"
#include "model/pio/pio_port.hpp"
#include "model/time/clock_domain.hpp"
#include "model/transaction/at_transport.hpp"

namespace model {

/// Runs firmware: the chip's one instruction stream. The firmware's C++ executes at once on a SystemC process
/// and runs ahead by a local cycle count; it synchronises with SystemC time where the host can see it
/// (semaphores shared with the host, the end) and wherever an observer asks for it. With an event queue it is
/// approximately timed: the PIO port lets time pass at each request, semaphore wait and kernel end, and mono
/// accesses are transactions of four phases.
///
/// Further hardware threads (loosely timed only) share that stream and its cycle count: ThreadScheduler says
/// which one has it. It changes hands at a semaphore wait that blocks and, for a thread of higher priority,
/// after a kernel, mono instructions, a request or a semaphore operation. What makes the control unit itself
/// stand still, a full PIO queue or a data cache miss, stops all threads.
class ControlUnit : public sc_core::sc_module, public cn::Machine, public SemaphorePort {
 public:
  sc_core::sc_port<PioPort> pio{"pio"};
  sc_core::sc_export<SemaphorePort> semaphores{"semaphores"};
  tlm_utils::simple_initiator_socket<ControlUnit> mono_socket{"mono_socket"};

  HostTrafficPort host_traffic{"host_traffic"};

  using Firmware = std::function<void(cn::Machine&)>;

  ControlUnit(const sc_core::sc_module_name& name, const ChipConfig& config, const ClockDomain& clock,
              PeArray& pe_array, EventQueue* event_queue = nullptr);

  /// What runs from `start()` on.
  void load(Firmware firmware) { firmware_ = std::move(firmware); }
  /// Called by the host: the firmware begins at the present SystemC time.
  void start();
  bool finished() const { return finished_; }
  /// What the firmware threw, if it did.
  void rethrow_failure() const;
  /// Once SystemC has nothing left to do: throws what the firmware threw, or cn::MachineFault with the wait
  /// graph if it has not come to its end.
  void require_finished() const;
  const sc_core::sc_event& finished_event() const { return finished_event_; }

  /// Semaphores that the host shares: the firmware's signals reach `host_event`, the host signals with
  /// host_signal().
  void share_with_host(cn::Semaphore semaphore);
  /// The wait graph at present (WaitRecord::deadlock).
  std::string deadlock() const;
  const sc_core::sc_event& host_event() const { return host_event_; }
  /// Takes one signal that the firmware has given by now; false when there is none.
  bool host_try_wait(cn::Semaphore semaphore);
  void host_signal(cn::Semaphore semaphore);
  /// What the host does for work that takes no time: runs at once when the firmware signals it outside timed
  /// code.
  void on_untimed_signal(std::function<void()> service) { untimed_service_ = std::move(service); }

  /// The firmware's cycle, at or ahead of SystemC's time.
  Cycles now() const { return now_; }
  /// When the firmware began.
  Cycles start_cycle() const { return start_cycle_; }
  const ControlStatistics& statistics() const { return statistics_; }

  /// Reports spans to `observer`; synchronises at least every `sync_cycles` so that they can be shown in
  /// time.
  void set_observer(ControlObserver* observer, Cycles sync_cycles);

  void sem_signal(cn::Semaphore semaphore) override;
  void sem_wait(cn::Semaphore semaphore) override;
  void issue_mono(std::uint64_t instructions) override;
  void timed(bool on) override;
  void start_thread(int priority, const std::string& name, std::function<void()> body) override;

  void report_fill(int block, const cn::LaneMask& slots) override;

  void signal_at(int index, Cycles at) override;

 protected:
  void retire(const char* kernel, const cn::IssueTree& issued) override;
  void start_transfer(const cn::Transfer& transfer) override;
  const void* read_mono_bytes(cn::MonoAddress from, std::size_t bytes) override;
  void write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) override;

 private:
  void run();
  void spend(CycleCause cause, Cycles cycles, int semaphore = -1);
  CycleCause cause_of_wait(cn::Semaphore semaphore) const;
  void wait_alone(cn::Semaphore semaphore);
  void wait_for_signal(cn::Semaphore semaphore);
  void wait_for_host(cn::Semaphore semaphore);
  void wait_for_host_event(std::optional<Cycles> at_the_latest);
  void wait_until(Cycles cycle);
  bool host_is_transferring() const { return host_traffic.size() > 0 && host_traffic->in_progress(); }
  /// Settles the PIO engine up to `cycle`; does not run ahead of the host while that uses the network.
  void settle_pio(Cycles cycle);
  void settle_pio_beside_host(Cycles cycle);
  bool serve_next_request();
  void report_begin(CycleCause cause, int semaphore = -1);
  void report_thread(int thread, ThreadState state);
  void synchronise();
  void synchronise_for_observer();
  void forget_mono_pointer(sc_dt::uint64 start, sc_dt::uint64 end);
  void fetch_line(cn::MonoAddress line);
  void send(tlm::tlm_command command, cn::MonoAddress address, std::uint8_t* data, std::size_t size);
  /// Sends transaction_ at now_; returns when it is over.
  Cycles transport();
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay);

  // Hardware threads (control_unit_threads.cpp):
  /// Firmware threads need stacks of their own. They are SystemC processes, since time passes (wait()) deep
  /// within firmware's calls and SystemC knows no other stacks. A process is spawned with the first switch to
  /// a thread that was started: firmware of one thread has none more. Only the one that has the control unit
  /// is ever awake for itself.
  struct ThreadProcess {
    std::function<void()> body;
    bool spawned;
    sc_core::sc_event go_on;
  };
  void run_thread(const std::function<void()>& body);
  void let_higher_priority_run();
  void wait_among_threads(cn::Semaphore semaphore);
  int choose_thread();
  ThreadScheduler::Ready wait_until_a_thread_is_ready();
  bool a_thread_waits_for_host() const;
  void dispatch(int thread);
  void switch_to(int thread, int self);
  void wake(int thread);
  void stop_other_threads();

  /// Firmware runs whole programs on this stack; SystemC's default of 256 KiB is for small processes.
  static constexpr int kFirmwareStackBytes = 8 << 20;

  const ChipConfig& config_;
  ClockDomain clock_;
  PeArray& pe_array_;
  SemaphoreFile semaphore_file_;
  WaitRecord wait_record_;
  ThreadScheduler threads_;
  std::vector<std::unique_ptr<ThreadProcess>>
      processes_;  ///< by slot; none before a second thread is started
  DataCache data_cache_;
  MonoWindow mono_window_;
  std::unique_ptr<AtTransport> at_transport_;
  tlm::tlm_generic_payload transaction_;
  std::vector<std::uint8_t> line_;
  std::array<bool, kSemaphores> waits_for_save_{};  ///< direction of the latest transfer that signals it
  std::array<bool, kSemaphores> shared_with_host_{};

  Firmware firmware_;
  std::function<void()> untimed_service_;
  Cycles now_ = 0;
  Cycles start_cycle_ = 0;
  bool timed_ = true;
  bool firmware_started_ = false;
  bool finished_ = false;
  std::exception_ptr failure_;
  sc_core::sc_event start_event_;
  sc_core::sc_event finished_event_;
  sc_core::sc_event host_event_;
  sc_core::sc_event signalled_by_host_;

  ControlObserver* observer_ = nullptr;
  Cycles sync_cycles_ = 0;
  Cycles next_sync_ = 0;
  ControlStatistics statistics_;
  PioWaits waits_up_to_last_kernel_;
};

}  // namespace model
