#include "model/wave_probe.hpp"

#include <sysc/tracing/sc_tracing_ids.h>
#include <algorithm>

#include "model/vcd_file.hpp"

namespace model {
namespace {

/// SystemC announces the time unit of a file, and warns of two samples at one time even if the second shows
/// no change. Nobody needs to read either.
class QuietTracing {
 public:
  QuietTracing()
      : time_unit_(set_time_unit(sc_core::SC_DO_NOTHING)),
        same_time_(set_same_time(sc_core::SC_DO_NOTHING)) {}
  QuietTracing(const QuietTracing&) = delete;
  QuietTracing& operator=(const QuietTracing&) = delete;
  ~QuietTracing() {
    set_time_unit(time_unit_);
    set_same_time(same_time_);
  }

 private:
  using Actions = sc_core::sc_actions;
  static Actions set_time_unit(Actions actions) {
    return sc_core::sc_report_handler::set_actions(sc_core::SC_ID_TRACING_TIMESCALE_UNIT_, sc_core::SC_INFO,
                                                   actions);
  }
  static Actions set_same_time(Actions actions) {
    return sc_core::sc_report_handler::set_actions(sc_core::SC_ID_TRACING_REVERSED_TIME_, sc_core::SC_WARNING,
                                                   actions);
  }

  Actions time_unit_;
  Actions same_time_;
};

/// SystemC samples when time goes on, so it never samples the last time of a run. This does what it would.
void sample(sc_core::sc_trace_file* file) {
  struct Sampler : sc_core::sc_trace_file {
    using sc_trace_file::cycle;
  };
  const QuietTracing quiet;
  (file->*&Sampler::cycle)(false);
}

void check(const WaveConfig& config) {
  const std::string file = config.vcd_file.string();
  if (config.vcd_file.extension() != ".vcd")
    throw WaveError("waves: found the file name '" + file + "'; allowed: a name that ends in .vcd");
  if (config.first_cycle >= config.last_cycle)
    throw WaveError(file + ": found a window from cycle " + std::to_string(config.first_cycle) +
                    " to before cycle " + std::to_string(config.last_cycle) +
                    "; allowed: one that ends after it begins");
  const std::string problem = create_vcd_file(config.vcd_file);
  if (!problem.empty())
    throw WaveError(file + ": found that it cannot be created (" + problem +
                    "); allowed: a file in an existing directory that can be written to");
}

bool is_count(WaveSignal signal) {
  return signal >= WaveSignal::ddr_page_hits;
}

}  // namespace

WaveProbe::WaveProbe(const sc_core::sc_module_name& name, const WaveConfig& config, const ClockDomain& clock,
                     MemorySampler memory)
    : sc_module(name), config_(config), clock_(clock), memory_(std::move(memory)) {
  check(config_);
  value_of(WaveSignal::control_semaphore) = kNoSemaphore;
  value_of(WaveSignal::pio_load_request) = kNoRequest;
  value_of(WaveSignal::pio_save_request) = kNoRequest;
  SC_HAS_PROCESS(WaveProbe);
  SC_METHOD(advance);
  sensitive << wake_;
}

WaveProbe::~WaveProbe() {
  if (window_ == Window::open) close_at_end_of_run();
}

void WaveProbe::began(CycleCause cause, Cycles start, int semaphore) {
  change(start, WaveSignal::control_state, std::uint64_t(cause) + 1);
  change(start, WaveSignal::control_semaphore, semaphore < 0 ? kNoSemaphore : std::uint64_t(semaphore));
  span_.emplace(start, cause);
}

void WaveProbe::spent(CycleCause cause, Cycles start, Cycles finish, int semaphore) {
  if (span_ != std::pair(start, cause)) began(cause, start, semaphore);
  // The next span, if one follows at once, replaces these in the same cycle.
  change(finish, WaveSignal::control_state, 0);
  change(finish, WaveSignal::control_semaphore, kNoSemaphore);
  if (cause == CycleCause::data_cache) change_memory_counters(finish);
}

void WaveProbe::began_kernel(const char* name, Cycles start, int enabled_pes) {
  change(start, WaveSignal::control_kernel, kernel_number(name));
  change(start, WaveSignal::pe_array_busy, 1);
  change(start, WaveSignal::pe_array_enabled_pes, std::uint64_t(enabled_pes));
  kernel_start_ = start;
}

void WaveProbe::ran_kernel(const char* name, Cycles start, Cycles finish, int enabled_pes) {
  if (kernel_start_ != start) began_kernel(name, start, enabled_pes);
  change(finish, WaveSignal::control_kernel, 0);
  change(finish, WaveSignal::pe_array_busy, 0);
  change(finish, WaveSignal::pe_array_enabled_pes, 0);
}

void WaveProbe::started(const PioEvent& event) {
  const bool load = event.direction == cn::Direction::mono_to_poly;
  change(event.started, load ? WaveSignal::pio_loading : WaveSignal::pio_saving, 1);
  change(event.started, load ? WaveSignal::pio_load_request : WaveSignal::pio_save_request,
         event.id & kNoRequest);
  change(event.started, load ? WaveSignal::pio_load_bytes : WaveSignal::pio_save_bytes, event.bytes);
  change(event.started, WaveSignal::pio_queue_depth, std::uint64_t(event.queue_depth));
}

void WaveProbe::finished(const PioEvent& event) {
  const bool load = event.direction == cn::Direction::mono_to_poly;
  change(event.finished, load ? WaveSignal::pio_loading : WaveSignal::pio_saving, 0);
  change(event.finished, load ? WaveSignal::pio_load_request : WaveSignal::pio_save_request, kNoRequest);
  change(event.finished, load ? WaveSignal::pio_load_bytes : WaveSignal::pio_save_bytes, 0);
  change_memory_counters(event.finished);
}

void WaveProbe::finish() {
  const std::string file = config_.vcd_file.string();
  if (window_ == Window::open) close_at_end_of_run();
  if (window_end_ > window_start_) {
    if (!std::filesystem::is_regular_file(config_.vcd_file)) return;  // a named pipe cannot be read back
    // SystemC computes time stamps in floating point; they may be off by one beyond 2^52 ps.
    const auto time = closing_time(config_.vcd_file);
    const std::uint64_t end = window_end_.value();
    if (time && *time + 1 >= end && *time <= end + 1) return;
    throw WaveError(file + ": found that it is not complete; allowed: a disk with room for it");
  }
  throw WaveError(file + ": found nothing that ran in the window from cycle " +
                  std::to_string(config_.first_cycle) + " to before cycle " +
                  std::to_string(config_.last_cycle) +
                  "; allowed: a window within the run, which ended at cycle " +
                  std::to_string(clock_.cycle_at(sc_core::sc_time_stamp())));
}

void WaveProbe::change_memory_counters(Cycles cycle) {
  const MemoryCounters counters = memory_();
  change(cycle, WaveSignal::ddr_page_hits, counters.page_hits);
  change(cycle, WaveSignal::ddr_page_misses, counters.page_misses);
  change(cycle, WaveSignal::ddr_bytes_read, counters.bytes_read);
  change(cycle, WaveSignal::ddr_bytes_written, counters.bytes_written);
  change(cycle, WaveSignal::clear_connect_pio_bytes, counters.pio_bytes);
}

std::uint64_t WaveProbe::kernel_number(const char* name) {
  const auto found = std::find(kernel_names_.begin(), kernel_names_.end(), name);
  const auto index = std::uint64_t(found - kernel_names_.begin());
  if (found == kernel_names_.end()) kernel_names_.emplace_back(name);
  return index + 1;
}

/// Each signal is reported in the order of its times; signals are not in order among each other.
void WaveProbe::change(Cycles cycle, WaveSignal signal, std::uint64_t value) {
  if (window_ == Window::over) return;
  if (cycle >= config_.last_cycle) {
    beyond_window_ = true;
  } else if (window_ == Window::before && cycle <= config_.first_cycle) {
    apply(signal, value);  // part of the initial values: nobody sees it earlier
    return;
  } else {
    changes_.push({cycle, reported_++, signal, value});
  }
  if (window_ == Window::open && clock_.time_at(cycle) < sc_core::sc_time_stamp()) ++late_changes_;
  wake_for_next();
}

void WaveProbe::apply_until(Cycles cycle) {
  for (; !changes_.empty() && changes_.top().cycle <= cycle; changes_.pop())
    apply(changes_.top().signal, changes_.top().value);
}

void WaveProbe::apply(WaveSignal signal, std::uint64_t value) {
  // Counts are taken when a request is booked and shown when it is over, and two engines overtake each other.
  value_of(signal) = is_count(signal) ? std::max<std::uint64_t>(value_of(signal), value) : value;
  value_of(WaveSignal::pio_state) = value_of(WaveSignal::pio_loading) + 2 * value_of(WaveSignal::pio_saving);
}

/// The only process. SystemC samples the values after it, before time goes on.
void WaveProbe::advance() {
  const Cycles now = clock_.cycle_at(sc_core::sc_time_stamp());
  if (now >= config_.last_cycle) {
    if (window_ == Window::open) close();
    window_ = Window::over;
    return;
  }
  if (window_ == Window::before && now >= config_.first_cycle) open();
  apply_until(now);
  wake_for_next();
}

/// Wakes up only for what was reported: a timer of its own would keep a simulation running that is otherwise
/// at its end.
void WaveProbe::wake_for_next() {
  if (window_ == Window::before) {
    if (!changes_.empty() || beyond_window_) wake_at(config_.first_cycle);
    return;
  }
  if (!changes_.empty()) wake_at(changes_.top().cycle);
  if (beyond_window_) wake_at(config_.last_cycle);
}

/// Of several notifications SystemC keeps the earliest.
void WaveProbe::wake_at(Cycles cycle) {
  const sc_core::sc_time time = clock_.time_at(cycle);
  const sc_core::sc_time& now = sc_core::sc_time_stamp();
  wake_.notify(time > now ? time - now : sc_core::SC_ZERO_TIME);
}

void WaveProbe::open() {
  const QuietTracing quiet;
  std::filesystem::path without_extension = config_.vcd_file;
  without_extension.replace_extension();  // SystemC appends it
  file_ = sc_core::sc_create_vcd_trace_file(without_extension.c_str());
  file_->set_time_unit(1, sc_core::SC_PS);
  for (const WaveSignalInfo& signal : wave_signal_table())
    sc_core::sc_trace(file_, value_of(signal.id), signal.path(), signal.width);
  window_start_ = sc_core::sc_time_stamp();
  window_ = Window::open;
}

void WaveProbe::close_at_end_of_run() {
  apply_until(clock_.cycle_at(sc_core::sc_time_stamp()));
  sample(file_);
  close();
}

void WaveProbe::close() {
  sc_core::sc_close_vcd_trace_file(file_);  // writes the present time
  window_end_ = sc_core::sc_time_stamp();
  window_ = Window::over;
  write_initial_time(config_.vcd_file, window_start_.value());
}

}  // namespace model
