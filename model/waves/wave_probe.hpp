#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <systemc>
#include <utility>
#include <vector>

#include "model/config/chip_config.hpp"
#include "model/observe/chip_observer.hpp"
#include "model/observe/search_observer.hpp"
#include "model/time/clock_domain.hpp"
#include "model/waves/block_windows.hpp"
#include "model/waves/name_numbers.hpp"
#include "model/waves/shown_signals.hpp"
#include "model/waves/wave_config.hpp"
#include "model/waves/wave_recorder.hpp"

namespace model {

/// Running counts of memory and network, as booked by now.
struct MemoryCounters {
  std::uint64_t page_hits = 0;
  std::uint64_t page_misses = 0;
  std::uint64_t bytes_read = 0;
  std::uint64_t bytes_written = 0;
  std::uint64_t pio_bytes = 0;  ///< bytes of programmed I/O across the network
};

/// Turns what the observed units report, ahead of SystemC time and not in one order, into the signals of
/// wave_signals.hpp. Wakes up only at cycles that were reported, to write what can no longer change. It calls
/// no observed unit, so no cycle depends on it.
class WaveProbe : public sc_core::sc_module,
                  public ChipObserver,
                  public DdrObserver,
                  public OnChipSramObserver,
                  public SearchObserver,
                  public PortObserver {
 public:
  using MemorySampler = std::function<MemoryCounters()>;

  /// Throws WaveError if the selection or a window is empty.
  WaveProbe(const sc_core::sc_module_name& name, const WaveConfig& config, const ChipConfig& chip,
            TextSink sink, MemorySampler memory);

  void began(CycleCause cause, Cycles start, int semaphore) override;
  void spent(CycleCause cause, Cycles start, Cycles finish, int semaphore) override;
  void kernel_details(const KernelDetails& details) override;
  void began_kernel(const char* name, Cycles start, int enabled_pes) override;
  void ran_kernel(const char* name, Cycles start, Cycles finish, int enabled_pes) override;
  void thread_changed(int thread, ThreadState state, Cycles at) override;
  void filled(int block, int slots, Cycles at) override;
  void started(const PioEvent& event) override;
  void finished(const PioEvent& event) override;
  void accessed(bool write, Cycles start, Cycles finish) override;
  void moved_data(bool write, Cycles start, Cycles finish) override;
  void commanded(int bank, DdrCommand command, std::uint64_t row, Cycles at) override;
  void sram_accessed(bool write, Cycles start, Cycles finish) override;
  void searching(int in_flight, int waiting, Cycles at) override;
  void passed(Initiator initiator, bool to_ddr, Cycles start, Cycles finish) override;
  void began_transfer(bool upload, std::uint64_t bytes, Cycles start) override;
  void ended_transfer(bool upload, std::uint64_t bytes, Cycles start, Cycles finish) override;

  /// After the run: ends a window that is still open at the present SystemC time. Throws WaveError if nothing
  /// ran in any window.
  void finish();

  /// What is recorded, in the order of the file.
  const std::vector<WaveInstance>& signals() const { return signals_.all(); }
  bool shows(WaveSignal signal) const { return signals_.any(signal); }
  /// Whether the DDR has to report single commands.
  bool shows_ddr_commands() const {
    return shows(WaveSignal::ddr_data) || shows(WaveSignal::ddr_bank_command) ||
           shows(WaveSignal::ddr_bank_row);
  }
  /// Kernels and stages by number, the first has number 1.
  const std::vector<std::string>& kernel_names() const { return kernels_.names(); }
  const std::vector<std::string>& bin_names() const { return bins_.names(); }
  /// Changes that were reported too late and are shown late. 0 as long as the observed units run ahead of
  /// SystemC time.
  std::uint64_t late_changes() const { return recorder_.late_changes(); }
  /// First and last time in the file.
  sc_core::sc_time window_start() const { return clock_.time_at(recorder_.first_recorded()); }
  sc_core::sc_time window_end() const { return clock_.time_at(recorder_.last_recorded()); }
  /// BlockWindows::block_starts().
  const std::vector<Cycles>& block_starts() const { return blocks_.block_starts(); }

 private:
  /// Changes of one stream come in the order of time. Streams of the banks follow.
  enum Stream : std::uint8_t {
    control_stream,
    load_stream,
    save_stream,
    to_ddr_stream,
    from_ddr_stream,
    bus_stream,
    data_stream,
    counts_stream,
    sram_stream,
    search_stream,
    host_stream,
    first_bank_stream
  };
  void change(std::size_t stream, Cycles cycle, WaveSignal signal, std::uint64_t value, int index = 0);
  void change_lanes(std::size_t stream, Cycles cycle, WaveSignal signal, const cn::LaneMask* lanes,
                    std::uint64_t value);
  void change_label(std::size_t stream, Cycles cycle, WaveSignal stage, const cn::Label& label);
  void change_memory_counters(Cycles cycle);
  std::uint64_t main_class(const cn::IssueTree& issued) const;
  void end_control();

  void advance();
  void wake_for(Cycles reported);

  ChipConfig chip_;
  ClockDomain clock_;
  MemorySampler memory_;
  ShownSignals signals_;
  WaveRecorder recorder_;
  bool shows_counters_;
  bool shows_pes_;
  std::string windows_text_;  ///< for messages

  BlockWindows blocks_;
  cn::Label computed_label_;
  std::vector<int> fill_by_block_;
  std::uint64_t fill_ = 0;
  KernelDetails details_{nullptr, nullptr, {}};
  NameNumbers kernels_;
  NameNumbers bins_;

  std::optional<std::pair<Cycles, CycleCause>> span_;  ///< start and cause of the latest span
  Cycles control_finish_ = 0;                          ///< end of the latest span
  std::optional<Cycles> kernel_start_;

  sc_core::sc_event wake_;
  bool wake_pending_ = false;
  Cycles latest_reported_ = 0;
};

}  // namespace model
