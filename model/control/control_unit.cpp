#include "model/control/control_unit.hpp"

#include <algorithm>
#include <stdexcept>

#include "model/faults/fault_injector.hpp"
#include "model/pe_array/stolen_cycles.hpp"

namespace model {

ControlUnit::ControlUnit(const sc_core::sc_module_name& name, const ChipConfig& config,
                         const ClockDomain& clock, PeArray& pe_array, EventQueue* event_queue)
    : sc_module(name),
      Machine(config.chip.pes, config.poly.sram_bytes),
      config_(config),
      approximately_timed_(event_queue != nullptr),
      pe_array_(pe_array),
      time_(clock, ledger_, pio, booked_traffic,
            approximately_timed_ ? TimingStyle::approximately_timed : TimingStyle::loosely_timed),
      semaphores_(semaphore_names()),
      host_semaphores_(semaphores_, time_, poly_memory()),
      threads_(config.control, ledger_, semaphores_, time_, host_semaphores_, pio),
      mono_access_(config, clock, ledger_, time_, poly_memory(), mono_socket, event_queue) {
  semaphores.bind(*this);
  time.bind(*this);
  mono_socket.register_invalidate_direct_mem_ptr(this, &ControlUnit::forget_mono_pointer);
  if (approximately_timed_) mono_socket.register_nb_transport_bw(this, &ControlUnit::nb_transport_bw);
  SC_HAS_PROCESS(ControlUnit);
  SC_THREAD(run);
  set_stack_size(kFirmwareStackBytes);
}

void ControlUnit::start() {
  if (start_asked_ || (firmware_started_ && !finished()))
    throw std::logic_error(std::string(name()) + ": start of firmware that has not come to its end");
  if (threads_.failed())
    throw std::logic_error(
        std::string(name()) +
        ": start after the firmware has failed; a chip that has failed must be built anew");
  start_asked_ = true;
  start_event_.notify(sc_core::SC_ZERO_TIME);
}

void ControlUnit::run() {
  for (;;) {
    while (!start_asked_) wait(start_event_);  // it may have been started before the simulation
    if (firmware_started_) begin_again();
    start_asked_ = false;
    firmware_started_ = true;
    ledger_.start(time_.present());
    if (faults_ != nullptr) faults_->firmware_starts(now());
    threads_.run_first([this] {
      if (firmware_) firmware_(*this);
    });
  }
}

void ControlUnit::begin_again() {
  while (pio->serve_next()) continue;  // what the firmware before has started and not waited for
  begin_program();
  ledger_.clear();
  semaphores_.clear();
  threads_.begin_again();
  mono_access_.empty_cache();
  timed_ = true;
}

void ControlUnit::time_passed() {
  if (faults_ != nullptr) faults_->time_passes(now());
  const std::uint64_t limit = config_.chip.watchdog_cycles;
  if (limit != 0 && now() - start_cycle() > limit)
    throw cn::MachineFault(std::string(kWatchdogMessage) + "the firmware has run for more than " +
                           std::to_string(limit) + " cycles (chip.watchdog_cycles)");
}

void ControlUnit::require_finished() const {
  rethrow_failure();
  if (finished()) return;
  if (firmware_started_) throw cn::MachineFault(semaphores_.deadlock(std::max(now(), time_.present())));
  throw cn::MachineFault("the firmware was not started: SystemC has nothing left to do");
}

void ControlUnit::timed(bool on) {
  timed_ = on;
  if (access_observer() != nullptr) access_observer()->timed(on);
}

void ControlUnit::start_thread(int priority, const std::string& name, std::function<void()> body) {
  if (approximately_timed_)
    throw cn::MachineFault("start of thread '" + name +
                           "': an approximately timed chip runs one hardware thread; run it loosely timed");
  threads_.start(priority, name, std::move(body));
  if (timed_) threads_.let_higher_priority_run();
}

void ControlUnit::program_search_unit(std::shared_ptr<cn::SearchFunction> function) {
  if (search_unit_ == nullptr) return Machine::program_search_unit(std::move(function));
  search_unit_->program(std::move(function));
}

void ControlUnit::report_fill(int block, const cn::LaneMask& slots) {
  if (ledger_.observer() != nullptr) ledger_.observer()->filled(block, slots.count(), now());
}

void ControlUnit::issue_mono(std::uint64_t instructions) {
  if (!timed_) return;
  ledger_.statistics().mono_instructions += instructions;
  const double cycles = config_.poly.code_quality_factor *
                        config_.poly.cycles[std::size_t(cn::InstructionClass::mono)] * double(instructions);
  ledger_.spend(CycleCause::mono, static_cast<Cycles>(cycles + 0.5));
  time_passed();
  threads_.let_higher_priority_run();
}

void ControlUnit::retire(const char* kernel, const cn::IssueTree& issued) {
  if (!timed_ || !issued.root().reached) return;
  const PeArray::Cost cost = pe_array_.retire(kernel, issued, ledger_.take_waits());
  const Cycles start = now();
  time_.settle_pio(start);
  const std::uint64_t words_before = pio->words_moved_before(start);
  report_kernel_begin(kernel, issued);
  time_.settle_pio(start + cost.cycles);
  const std::uint64_t words = pio->words_moved_before(start + cost.cycles) - words_before;
  ledger_.spend(CycleCause::poly, cost.cycles);
  ledger_.spend(CycleCause::stolen,
                stolen_cycles(words, config_.pio.stolen_sram_cycles, cost.sram_cycles, cost.cycles));
  semaphores_.record().ran_kernel(kernel, now());
  report_kernel_end(kernel, issued, start);
  if (faults_ != nullptr) faults_->kernel_ends(now());
  time_passed();
  time_.synchronise_for_observer();
  threads_.let_higher_priority_run();
}

void ControlUnit::report_kernel_begin(const char* kernel, const cn::IssueTree& issued) {
  ControlObserver* const observer = ledger_.observer();
  if (observer == nullptr) return;
  ledger_.report_begin(CycleCause::poly);
  observer->kernel_details({kernel_lanes(), &issued, label()});
  observer->began_kernel(kernel, now(), static_cast<int>(issued.root().enabled_lanes));
}

void ControlUnit::report_kernel_end(const char* kernel, const cn::IssueTree& issued, Cycles start) {
  if (ledger_.observer() == nullptr) return;
  ledger_.observer()->ran_kernel(kernel, start, now(), static_cast<int>(issued.root().enabled_lanes));
}

void ControlUnit::start_transfer(const cn::Transfer& transfer) {
  if (!timed_) return mono_access_.move_untimed(transfer);
  semaphores_.record().started(transfer, now());
  ledger_.spend(CycleCause::transfer_call, Cycles(config_.control.transfer_call_cycles));
  time_.settle_pio(now());
  ledger_.report_begin(CycleCause::wait_pio_queue);
  if (faults_ == nullptr) {
    ledger_.spend_until(pio->enqueue(transfer, now()), CycleCause::wait_pio_queue);
  } else {
    cn::Transfer in_truth = transfer;
    in_truth.enabled = faults_->enabled_for_transfer(transfer.enabled);
    ledger_.spend_until(pio->enqueue(in_truth, now()), CycleCause::wait_pio_queue);
  }
  time_passed();
  threads_.let_higher_priority_run();
}

void ControlUnit::sem_signal(cn::Semaphore semaphore) {
  if (!timed_) return host_semaphores_.serve_untimed_signal();
  ledger_.spend(CycleCause::semaphore, Cycles(config_.control.semaphore_cycles), semaphore.index);
  semaphores_.signal(semaphore.index, Signaller::control_unit, now());
  if (access_observer() != nullptr) access_observer()->signalled(semaphore);
  if (semaphores_.is_shared_with_host(semaphore.index)) {
    time_.synchronise();
    host_semaphores_.tell_host();
  }
  threads_.let_higher_priority_run();
}

void ControlUnit::sem_wait(cn::Semaphore semaphore) {
  if (!timed_) return;
  ledger_.spend(CycleCause::semaphore, Cycles(config_.control.semaphore_cycles), semaphore.index);
  threads_.let_higher_priority_run();
  time_.settle_pio(now());
  threads_.wait(semaphore);
  time_passed();
  if (access_observer() != nullptr) access_observer()->waited(semaphore);
  time_.synchronise_for_observer();
}

const void* ControlUnit::read_mono_bytes(cn::MonoAddress from, std::size_t bytes) {
  return timed_ ? mono_access_.read(from, bytes) : mono_access_.read_untimed(from, bytes);
}

void ControlUnit::write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) {
  if (!timed_) return mono_access_.write_untimed(to, bytes, size);
  issue_mono(1);
  mono_access_.write(to, bytes, size);
}

}  // namespace model
