#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace model {

/// Every signal of the waves, in the order in which files and views show them.
enum class WaveSignal : std::uint8_t {
  control_state,
  control_kernel,
  control_semaphore,
  pe_array_busy,
  pe_array_enabled_pes,
  pio_state,
  pio_loading,
  pio_saving,
  pio_queue_depth,
  pio_load_request,
  pio_load_bytes,
  pio_save_request,
  pio_save_bytes,
  ddr_page_hits,
  ddr_page_misses,
  ddr_bytes_read,
  ddr_bytes_written,
  clear_connect_pio_bytes,
};
inline constexpr int kWaveSignals = static_cast<int>(WaveSignal::clear_connect_pio_bytes) + 1;

inline constexpr std::uint64_t kNoSemaphore = 0xff;        ///< of control.semaphore
inline constexpr std::uint64_t kNoRequest = 0xffff'ffffu;  ///< of pio.load_request and pio.save_request

struct ValueName {
  std::uint64_t value;
  std::string name;
};

/// How a viewer should draw a signal.
enum class WaveForm : std::uint8_t { bit, number, plot };

/// One signal: the only declaration of its name, width and meaning. Trace files, views and waves/README.md
/// are made from it.
struct WaveSignalInfo {
  WaveSignal id;
  std::string_view scope;
  std::string_view name;
  int width;  ///< bits
  WaveForm form;
  std::string_view meaning;
  std::vector<ValueName> value_names;  ///< text for values; empty for plain numbers and for kernels

  std::string path() const { return std::string(scope) + "." + std::string(name); }
};

/// In the order of WaveSignal; the signals of a scope follow each other.
const std::vector<WaveSignalInfo>& wave_signal_table();

/// What the values of a signal are called; empty when they are plain numbers. Kernels are numbered from 1 in
/// the order of `kernel_names`.
std::vector<ValueName> wave_value_names(const WaveSignalInfo& signal,
                                        const std::vector<std::string>& kernel_names);

/// The table for waves/README.md.
std::string wave_signal_markdown();

}  // namespace model
