#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <queue>
#include <stdexcept>
#include <string>
#include <systemc>
#include <utility>
#include <vector>

#include "model/clock_domain.hpp"
#include "model/control_observer.hpp"
#include "model/pio_observer.hpp"
#include "model/wave_signals.hpp"

namespace model {

/// Waves that cannot be written, in one line: file, what was found, what is allowed.
class WaveError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct WaveConfig {
  std::filesystem::path vcd_file;  ///< ends in ".vcd"; may be a named pipe
  Cycles first_cycle = 0;          ///< the window is [first_cycle, last_cycle)
  Cycles last_cycle = std::numeric_limits<Cycles>::max();
};

/// Running counts of the memory side, as booked by now.
struct MemoryCounters {
  std::uint64_t page_hits = 0;
  std::uint64_t page_misses = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_written = 0;
  std::uint64_t pio_bytes = 0;  ///< across the network
};

/// Turns what the observed units report, ahead of SystemC time and not in one order, into the signals of
/// wave_signals.hpp, each changed at its own SystemC time, and has SystemC write them to a VCD file. Wakes up
/// only at cycles that were reported and at the ends of the window, and only inside of it; calls nothing of
/// what it observes, so no cycle depends on it.
class WaveProbe : public sc_core::sc_module, public ControlObserver, public PioObserver {
 public:
  using MemorySampler = std::function<MemoryCounters()>;

  /// Creates the file. Throws WaveError if that is not possible or the window is empty.
  WaveProbe(const sc_core::sc_module_name& name, const WaveConfig& config, const ClockDomain& clock,
            MemorySampler memory);
  /// Closes the file; whether it is complete only finish() tells.
  ~WaveProbe() override;

  void began(CycleCause cause, Cycles start, int semaphore) override;
  void began_kernel(const char* name, Cycles start, int enabled_pes) override;
  void spent(CycleCause cause, Cycles start, Cycles finish, int semaphore) override;
  void ran_kernel(const char* name, Cycles start, Cycles finish, int enabled_pes) override;
  void started(const PioEvent& event) override;
  void finished(const PioEvent& event) override;

  /// After the run: ends a window that is still open at the present SystemC time. Throws WaveError if nothing
  /// ran in the window or the file is not complete (disk full).
  void finish();

  /// Kernels by number, the first has number 1.
  const std::vector<std::string>& kernel_names() const { return kernel_names_; }
  /// Changes that were reported after their time while the window was open, and are shown late. 0 as long as
  /// the observed units run ahead of SystemC time.
  std::uint64_t late_changes() const { return late_changes_; }
  /// What the file covers.
  sc_core::sc_time window_start() const { return window_start_; }
  sc_core::sc_time window_end() const { return window_end_; }

 private:
  enum class Window : std::uint8_t { before, open, over };
  struct Change {
    Cycles cycle;
    std::uint64_t order;  ///< of reporting: the last one of a cycle holds
    WaveSignal signal;
    std::uint64_t value;

    bool operator<(const Change& other) const {  // std::priority_queue has its largest element on top
      return cycle != other.cycle ? cycle > other.cycle : order > other.order;
    }
  };

  void change(Cycles cycle, WaveSignal signal, std::uint64_t value);
  void change_memory_counters(Cycles cycle);
  std::uint64_t kernel_number(const char* name);

  void advance();
  void wake_at(Cycles cycle);
  void wake_for_next();
  void apply_until(Cycles cycle);
  void apply(WaveSignal signal, std::uint64_t value);
  sc_dt::uint64& value_of(WaveSignal signal) { return values_[std::size_t(signal)]; }
  void open();
  void close_at_end_of_run();
  void close();

  WaveConfig config_;
  ClockDomain clock_;
  MemorySampler memory_;

  std::array<sc_dt::uint64, kWaveSignals> values_{};  ///< what SystemC samples
  std::priority_queue<Change> changes_;
  std::uint64_t reported_ = 0;
  bool beyond_window_ = false;  ///< something was reported that happens after the window
  sc_core::sc_event wake_;

  Window window_ = Window::before;
  sc_core::sc_trace_file* file_ = nullptr;
  sc_core::sc_time window_start_;
  sc_core::sc_time window_end_;
  std::vector<std::string> kernel_names_;
  std::optional<std::pair<Cycles, CycleCause>> span_;  ///< that began last
  std::optional<Cycles> kernel_start_;
  std::uint64_t late_changes_ = 0;
};

}  // namespace model
