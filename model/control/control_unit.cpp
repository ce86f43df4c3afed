#include "model/control/control_unit.hpp"

#include <algorithm>
#include <cstring>

#include "model/time/annotated_delay.hpp"
#include "model/transaction/payload.hpp"

namespace model {

ControlUnit::ControlUnit(const sc_core::sc_module_name& name, const ChipConfig& config,
                         const ClockDomain& clock, PeArray& pe_array, EventQueue* event_queue)
    : sc_module(name),
      Machine(config.chip.pes, config.poly.sram_bytes),
      config_(config),
      clock_(clock),
      pe_array_(pe_array),
      threads_(config.control.threads, cn::kFirstThreadPriority),
      processes_(std::size_t(config.control.threads)),
      data_cache_(config.control.data_cache_bytes, config.control.cache_line_bytes),
      mono_window_(config.ddr.size_bytes, poly_memory()),
      line_(std::size_t(config.control.cache_line_bytes)) {
  semaphores.bind(*this);
  mono_socket.register_invalidate_direct_mem_ptr(this, &ControlUnit::forget_mono_pointer);
  if (event_queue != nullptr) {
    at_transport_ = std::make_unique<AtTransport>(*event_queue, mono_socket);
    mono_socket.register_nb_transport_bw(this, &ControlUnit::nb_transport_bw);
  }
  SC_HAS_PROCESS(ControlUnit);
  SC_THREAD(run);
  set_stack_size(kFirmwareStackBytes);
}

void ControlUnit::forget_mono_pointer(sc_dt::uint64, sc_dt::uint64) {
  mono_window_.invalidate();
}

void ControlUnit::start() {
  start_event_.notify(sc_core::SC_ZERO_TIME);
}

void ControlUnit::run() {
  wait(start_event_);
  now_ = clock_.cycle_at(sc_core::sc_time_stamp());
  start_cycle_ = now_;
  firmware_started_ = true;
  report_thread(threads_.running(), ThreadState::running);
  run_thread([this] {
    if (firmware_) firmware_(*this);
  });
}

void ControlUnit::rethrow_failure() const {
  if (failure_) std::rethrow_exception(failure_);
}

void ControlUnit::require_finished() const {
  rethrow_failure();
  if (finished_) return;
  if (firmware_started_) throw cn::MachineFault(deadlock());
  throw cn::MachineFault("the firmware was not started: SystemC has nothing left to do");
}

std::string ControlUnit::deadlock() const {
  return wait_record_.deadlock(std::max(now_, clock_.cycle_at(sc_core::sc_time_stamp())), semaphore_file_,
                               semaphore_names());
}

void ControlUnit::set_observer(ControlObserver* observer, Cycles sync_cycles) {
  observer_ = observer;
  sync_cycles_ = sync_cycles;
}

void ControlUnit::spend(CycleCause cause, Cycles cycles, int semaphore) {
  if (cycles == 0) return;
  statistics_.cycles[std::size_t(cause)] += cycles;
  if (observer_ != nullptr) observer_->spent(cause, now_, now_ + cycles, semaphore);
  now_ += cycles;
}

void ControlUnit::report_begin(CycleCause cause, int semaphore) {
  if (observer_ != nullptr) observer_->began(cause, now_, semaphore);
}

void ControlUnit::report_thread(int thread, ThreadState state) {
  if (observer_ != nullptr) observer_->thread_changed(thread, state, now_);
}

void ControlUnit::report_fill(int block, const cn::LaneMask& slots) {
  if (observer_ != nullptr) observer_->filled(block, slots.count(), now_);
}

void ControlUnit::wait_until(Cycles cycle) {
  if (host_traffic.size() > 0) host_traffic->book_until(cycle);
  const sc_core::sc_time target = clock_.time_at(cycle);
  if (target > sc_core::sc_time_stamp()) wait(target - sc_core::sc_time_stamp());
}

void ControlUnit::synchronise() {
  settle_pio(now_);
  wait_until(now_);
}

/// What the host begins next must not come after requests that were booked for later.
void ControlUnit::settle_pio(Cycles cycle) {
  if (host_is_transferring()) settle_pio_beside_host(cycle);
  pio->settle(cycle);
}

void ControlUnit::settle_pio_beside_host(Cycles cycle) {
  for (auto next = pio->next_start(); host_is_transferring() && next && *next <= cycle;
       next = pio->next_start()) {
    wait_until(*next);
    wait(sc_core::SC_ZERO_TIME);  // the host's process comes first
    pio->settle(*next);
  }
  if (host_is_transferring()) {
    wait_until(cycle);
    wait(sc_core::SC_ZERO_TIME);
  }
}

bool ControlUnit::serve_next_request() {
  const std::optional<Cycles> next = pio->next_start();
  if (!next || !host_is_transferring()) return pio->serve_next();
  settle_pio(*next);
  return true;
}

/// What was reported lies in the future of SystemC time; here it becomes the present, before too much piles
/// up.
void ControlUnit::synchronise_for_observer() {
  if (observer_ == nullptr || now_ < next_sync_) return;
  next_sync_ = now_ + sync_cycles_;
  synchronise();
}

void ControlUnit::timed(bool on) {
  timed_ = on;
  if (access_observer() != nullptr) access_observer()->timed(on);
}

void ControlUnit::issue_mono(std::uint64_t instructions) {
  if (!timed_) return;
  statistics_.mono_instructions += instructions;
  const double cycles = config_.poly.code_quality_factor *
                        config_.poly.cycles[std::size_t(cn::InstructionClass::mono)] * double(instructions);
  spend(CycleCause::mono, static_cast<Cycles>(cycles + 0.5));
  let_higher_priority_run();
}

void ControlUnit::retire(const char* kernel, const cn::IssueTree& issued) {
  if (!timed_ || !issued.root().reached) return;
  const PioWaits waits = statistics_.pio_waits();
  const PeArray::Cost cost = pe_array_.retire(kernel, issued, waits - waits_up_to_last_kernel_);
  waits_up_to_last_kernel_ = waits;
  const Cycles start = now_;
  settle_pio(start);
  const std::uint64_t words_before = pio->words_moved_before(start);
  if (observer_ != nullptr) {
    report_begin(CycleCause::poly);
    observer_->kernel_details({kernel_lanes(), &issued, label()});
    observer_->began_kernel(kernel, start, static_cast<int>(issued.root().enabled_lanes));
  }
  settle_pio(start + cost.cycles);
  const std::uint64_t words = pio->words_moved_before(start + cost.cycles) - words_before;
  spend(CycleCause::poly, cost.cycles);
  spend(CycleCause::stolen,
        stolen_cycles(words, config_.pio.stolen_sram_cycles, cost.sram_cycles, cost.cycles));
  wait_record_.ran_kernel(kernel, now_);
  if (observer_ != nullptr)
    observer_->ran_kernel(kernel, start, now_, static_cast<int>(issued.root().enabled_lanes));
  synchronise_for_observer();
  let_higher_priority_run();
}

void ControlUnit::start_transfer(const cn::Transfer& transfer) {
  if (!timed_) {
    mono_window_.check_span(transfer, 0);
    mono_window_.check_places(transfer, 0);
    mono_window_.move(transfer, *mono_socket.operator->());
    return;
  }
  wait_record_.started(transfer, now_);
  spend(CycleCause::transfer_call, Cycles(config_.control.transfer_call_cycles));
  waits_for_save_[std::size_t(transfer.done.index)] = transfer.direction == cn::Direction::poly_to_mono;
  settle_pio(now_);
  report_begin(CycleCause::wait_pio_queue);
  const Cycles go_on = pio->enqueue(transfer, now_);
  spend(CycleCause::wait_pio_queue, go_on - now_);
  let_higher_priority_run();
}

void ControlUnit::signal_at(int index, Cycles at) {
  semaphore_file_.signal(index, at);
  wait_record_.signalled(index, Signaller::pio, at);
}

void ControlUnit::sem_signal(cn::Semaphore semaphore) {
  if (!timed_) {
    if (untimed_service_) untimed_service_();
    return;
  }
  spend(CycleCause::semaphore, Cycles(config_.control.semaphore_cycles), semaphore.index);
  semaphore_file_.signal(semaphore.index, now_);
  wait_record_.signalled(semaphore.index, Signaller::control_unit, now_);
  if (access_observer() != nullptr) access_observer()->signalled(semaphore);
  if (shared_with_host_[std::size_t(semaphore.index)]) {
    synchronise();
    host_event_.notify(sc_core::SC_ZERO_TIME);
    for (int delta = 0; delta < 2; ++delta) wait(sc_core::SC_ZERO_TIME);  // what it begins now comes first
  }
  let_higher_priority_run();
}

void ControlUnit::sem_wait(cn::Semaphore semaphore) {
  if (!timed_) return;
  spend(CycleCause::semaphore, Cycles(config_.control.semaphore_cycles), semaphore.index);
  let_higher_priority_run();
  settle_pio(now_);
  if (threads_.alive() > 1) {
    wait_among_threads(semaphore);
  } else {
    wait_alone(semaphore);
  }
  if (access_observer() != nullptr) access_observer()->waited(semaphore);
  synchronise_for_observer();
}

void ControlUnit::wait_alone(cn::Semaphore semaphore) {
  wait_record_.waits(Waiter::control_unit, semaphore, now_);
  report_thread(threads_.running(), ThreadState::waiting);
  if (shared_with_host_[std::size_t(semaphore.index)]) {
    wait_for_host(semaphore);
  } else {
    wait_for_signal(semaphore);
  }
  wait_record_.goes_on(Waiter::control_unit, now_);
  report_thread(threads_.running(), ThreadState::running);
}

CycleCause ControlUnit::cause_of_wait(cn::Semaphore semaphore) const {
  if (shared_with_host_[std::size_t(semaphore.index)]) return CycleCause::wait_host;
  return waits_for_save_[std::size_t(semaphore.index)] ? CycleCause::wait_save : CycleCause::wait_load;
}

void ControlUnit::wait_for_signal(cn::Semaphore semaphore) {
  const CycleCause cause = cause_of_wait(semaphore);
  std::optional<Cycles> at = semaphore_file_.take(semaphore.index);
  if (!at) report_begin(cause, semaphore.index);
  // Nobody can queue another request while the only thread waits, so the engine may decide on and on.
  while (!at && serve_next_request()) at = semaphore_file_.take(semaphore.index);
  if (!at) throw cn::MachineFault(deadlock());
  if (*at > now_) spend(cause, *at - now_, semaphore.index);
}

void ControlUnit::wait_for_host(cn::Semaphore semaphore) {
  std::optional<Cycles> at = semaphore_file_.take(semaphore.index);
  if (!at) {
    synchronise();  // the host may answer while time catches up
    report_begin(CycleCause::wait_host, semaphore.index);
    at = semaphore_file_.take(semaphore.index);
  }
  for (; !at; at = semaphore_file_.take(semaphore.index)) wait_for_host_event(pio->next_start());
  if (*at > now_) spend(CycleCause::wait_host, *at - now_, semaphore.index);
}

/// Lets time pass until the host signals something or `at_the_latest` has come, the start of the next queued
/// request if there is one: it is served in its time.
void ControlUnit::wait_for_host_event(std::optional<Cycles> at_the_latest) {
  if (at_the_latest) {
    if (host_traffic.size() > 0) host_traffic->book_until(*at_the_latest);
    wait(clock_.time_at(*at_the_latest) - sc_core::sc_time_stamp(), signalled_by_host_);
  } else {
    wait(signalled_by_host_);
  }
  pio->settle(clock_.cycle_at(sc_core::sc_time_stamp()));
}

void ControlUnit::share_with_host(cn::Semaphore semaphore) {
  shared_with_host_.at(std::size_t(semaphore.index)) = true;
  wait_record_.share_with_host(semaphore);
}

bool ControlUnit::host_try_wait(cn::Semaphore semaphore) {
  const Cycles cycle = clock_.cycle_at(sc_core::sc_time_stamp());
  wait_record_.waits(Waiter::host, semaphore, cycle);
  if (!semaphore_file_.has_signal(semaphore.index, cycle)) return false;
  semaphore_file_.take(semaphore.index);
  wait_record_.goes_on(Waiter::host, cycle);
  if (access_observer() != nullptr) access_observer()->waited(semaphore);
  return true;
}

void ControlUnit::host_signal(cn::Semaphore semaphore) {
  const Cycles cycle = clock_.cycle_at(sc_core::sc_time_stamp());
  semaphore_file_.signal(semaphore.index, cycle);
  wait_record_.signalled(semaphore.index, Signaller::host, cycle);
  if (access_observer() != nullptr) access_observer()->signalled(semaphore);
  signalled_by_host_.notify(sc_core::SC_ZERO_TIME);
}

const void* ControlUnit::read_mono_bytes(cn::MonoAddress from, std::size_t bytes) {
  const void* const data = mono_window_.view(from, bytes, *mono_socket.operator->());
  if (!timed_) return data;
  const std::uint64_t last = data_cache_.line_of(from + bytes - 1);
  for (std::uint64_t line = data_cache_.line_of(from); line <= last; ++line) {
    if (data_cache_.touch(line)) {
      ++statistics_.data_cache_hits;
    } else {
      ++statistics_.data_cache_misses;
      fetch_line(line * data_cache_.line_bytes());
    }
  }
  return data;
}

void ControlUnit::fetch_line(cn::MonoAddress line) {
  settle_pio(now_);
  send(tlm::TLM_READ_COMMAND, line, line_.data(), line_.size());
}

/// Write-through, and the control unit waits until the memory has it: what it tells the host must be there
/// before the signal is.
void ControlUnit::write_mono_bytes(cn::MonoAddress to, const void* bytes, std::size_t size) {
  if (!timed_) {
    mono_window_.write(to, bytes, size, *mono_socket.operator->());
    return;
  }
  issue_mono(1);
  settle_pio(now_);
  std::vector<std::uint8_t> data(size);
  std::memcpy(data.data(), bytes, size);
  send(tlm::TLM_WRITE_COMMAND, to, data.data(), size);
}

void ControlUnit::send(tlm::tlm_command command, cn::MonoAddress address, std::uint8_t* data,
                       std::size_t size) {
  set_access(transaction_, command, address, data, size);
  report_begin(CycleCause::data_cache);
  const Cycles over = transport();
  if (transaction_.is_response_error())
    throw cn::MachineFault("mono access of " + std::to_string(size) + " bytes at " + std::to_string(address) +
                           ": " + transaction_.get_response_string());
  spend(CycleCause::data_cache, over - now_ + Cycles(config_.control.cache_miss_cycles));
}

tlm::tlm_sync_enum ControlUnit::nb_transport_bw(tlm::tlm_generic_payload& payload, tlm::tlm_phase& phase,
                                                sc_core::sc_time& delay) {
  return at_transport_->nb_transport_bw(payload, phase, delay);
}

Cycles ControlUnit::transport() {
  if (at_transport_) return at_transport_->transport(transaction_);
  sc_core::sc_time delay = delay_until(clock_, now_);
  mono_socket->b_transport(transaction_, delay);
  return cycle_of_delay(clock_, delay);
}

}  // namespace model
