#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "model/config/chip_config.hpp"

namespace model {

/// Every kind of signal of the waves, in the order in which files and views show them.
enum class WaveSignal : std::uint8_t {
  bins_load_stage,
  bins_load_block,
  bins_compute_stage,
  bins_compute_block,
  bins_save_stage,
  bins_save_block,
  bins_fill,
  control_state,
  control_kernel,
  control_semaphore,
  control_thread,
  pe_array_busy,
  pe_array_enabled_pes,
  pe_array_instruction_class,
  pe_enabled,
  pe_transfer,
  pio_loading,
  pio_saving,
  pio_queue_depth,
  pio_load_request,
  pio_load_bytes,
  pio_save_request,
  pio_save_bytes,
  clear_connect_to_ddr,
  clear_connect_from_ddr,
  clear_connect_pio_bytes,
  ddr_bus,
  ddr_data,
  ddr_page_hits,
  ddr_page_misses,
  ddr_bytes_read,
  ddr_bytes_written,
  ddr_bank_command,
  ddr_bank_row,
  on_chip_sram_port,
  search_unit_queries,
  search_unit_waiting,
  host_link_state,
};
inline constexpr int kWaveSignals = static_cast<int>(WaveSignal::host_link_state) + 1;

inline constexpr std::uint64_t kNoSemaphore = 0xff;        ///< value of control.semaphore
inline constexpr std::uint64_t kNoRequest = 0xffff'ffffu;  ///< value of pio.load_request and pio.save_request
inline constexpr std::uint64_t kNoBlock = 0xffff;          ///< value of bins.*_block

/// How much is shown: each level includes the ones before.
enum class WaveLevel : std::uint8_t {
  overview,  ///< what overlaps with what
  units,     ///< each unit's state and requests; the default
  detail,    ///< single commands, running counts, single PEs
};
inline constexpr int kWaveLevels = static_cast<int>(WaveLevel::detail) + 1;
const char* wave_level_name(WaveLevel level);

/// What has one such signal each. `search_unit`: the chip, if it has search units.
enum class WaveCount : std::uint8_t { chip, search_unit, thread, bank, pe };

struct ValueName {
  std::uint64_t value;
  std::string name;
};

/// Where the names of a signal's values come from.
enum class WaveNames : std::uint8_t { none, fixed, kernels, semaphores, bins };

/// How a viewer should draw a signal.
enum class WaveForm : std::uint8_t { bit, number, plot };

/// What a signal is about; views give each a colour.
enum class WaveTopic : std::uint8_t { other, load, compute, save };

/// One row of the table: the only declaration of a signal's name, width, meaning, level and group. Trace
/// files, views, value names and waves/README.md are made from it.
struct WaveSignalInfo {
  WaveSignal id;
  std::string_view scope;
  std::string_view name;
  int width;  ///< bits
  WaveForm form;
  WaveLevel level;
  WaveCount count;
  WaveTopic topic;
  std::string_view meaning;
  WaveNames names = WaveNames::none;
  std::vector<ValueName> fixed_names{};  ///< values that mean the same in every run

  /// Scope and name; an asterisk stands for the number if there are several.
  std::string path() const;
};

/// In the order of WaveSignal; the signals of a scope follow each other.
const std::vector<WaveSignalInfo>& wave_signal_table();

/// One signal of one chip.
struct WaveInstance {
  const WaveSignalInfo* info;
  int index;         ///< thread, bank or PE; 0 for the chip's own
  std::string path;  ///< "pe_array.pe_07.enabled": numbers as wide as the last, so that names sort naturally
};

/// Every signal that a chip has, in the order of the table.
std::vector<WaveInstance> wave_instances(const ChipConfig& config);

/// The path in a file whose root scope is the chip's name.
std::string wave_name_in_file(const std::string& chip, const WaveInstance& signal);

/// How many instances a chip has of a kind.
int wave_count(const ChipConfig& config, WaveCount count);

/// The table for waves/README.md.
std::string wave_signal_markdown();

}  // namespace model
