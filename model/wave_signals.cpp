#include "model/wave_signals.hpp"

#include "model/control_observer.hpp"

namespace model {
namespace {

std::vector<ValueName> control_state_names() {
  std::vector<ValueName> names = {{0, "idle"}};
  for (int cause = 0; cause < kCycleCauses; ++cause)
    names.push_back({std::uint64_t(cause) + 1, cycle_cause_name(static_cast<CycleCause>(cause))});
  return names;
}

std::vector<WaveSignalInfo> make_table() {
  using Signal = WaveSignal;
  using Form = WaveForm;
  const std::vector<ValueName> no_request = {{kNoRequest, "none"}};
  return {
      {Signal::control_state, "control", "state", 4, Form::number,
       "what the control unit spends its cycles on; every cycle has one cause", control_state_names()},
      {Signal::control_kernel,
       "control",
       "kernel",
       16,
       Form::number,
       "number of the kernel that runs, in the order in which kernels first ran; 0: none",
       {}},
      {Signal::control_semaphore,
       "control",
       "semaphore",
       8,
       Form::number,
       "semaphore that is signalled or waited on",
       {{kNoSemaphore, "none"}}},

      {Signal::pe_array_busy,
       "pe_array",
       "busy",
       1,
       Form::bit,
       "1 while a kernel runs, cycles stolen by programmed I/O included",
       {}},
      {Signal::pe_array_enabled_pes,
       "pe_array",
       "enabled_pes",
       11,
       Form::plot,
       "PEs that the kernel was started for; 0 between kernels",
       {}},

      {Signal::pio_state,
       "pio",
       "state",
       2,
       Form::number,
       "what programmed I/O does: loading + 2 saving",
       {{0, "idle"}, {1, "mono_to_poly"}, {2, "poly_to_mono"}, {3, "both"}}},
      {Signal::pio_loading,
       "pio",
       "loading",
       1,
       Form::bit,
       "1 while a mono-to-poly request is in service, from its setup to its last byte",
       {}},
      {Signal::pio_saving,
       "pio",
       "saving",
       1,
       Form::bit,
       "1 while a poly-to-mono request is in service, from its setup to its last byte",
       {}},
      {Signal::pio_queue_depth,
       "pio",
       "queue_depth",
       16,
       Form::plot,
       "requests that waited when the latest one started",
       {}},
      {Signal::pio_load_request, "pio", "load_request", 32, Form::number,
       "id of the mono-to-poly request in service", no_request},
      {Signal::pio_load_bytes,
       "pio",
       "load_bytes",
       32,
       Form::number,
       "bytes that it moves in all PEs; 0: none",
       {}},
      {Signal::pio_save_request, "pio", "save_request", 32, Form::number,
       "id of the poly-to-mono request in service", no_request},
      {Signal::pio_save_bytes,
       "pio",
       "save_bytes",
       32,
       Form::number,
       "bytes that it moves in all PEs; 0: none",
       {}},

      {Signal::ddr_page_hits,
       "ddr",
       "page_hits",
       64,
       Form::number,
       "accesses to open pages so far; like all counts of memory, updated when a request or cache line is "
       "over",
       {}},
      {Signal::ddr_page_misses,
       "ddr",
       "page_misses",
       64,
       Form::number,
       "accesses so far that had to open a page",
       {}},
      {Signal::ddr_bytes_read, "ddr", "bytes_read", 64, Form::number, "bytes read so far", {}},
      {Signal::ddr_bytes_written, "ddr", "bytes_written", 64, Form::number, "bytes written so far", {}},

      {Signal::clear_connect_pio_bytes,
       "clear_connect",
       "pio_bytes",
       64,
       Form::number,
       "bytes so far that crossed the on-chip network for programmed I/O",
       {}},
  };
}

std::string values_text(const WaveSignalInfo& signal) {
  std::string text;
  for (const ValueName& value : signal.value_names)
    text += (text.empty() ? "" : ", ") + std::to_string(value.value) + " " + value.name;
  return text;
}

}  // namespace

const std::vector<WaveSignalInfo>& wave_signal_table() {
  static const std::vector<WaveSignalInfo> table = make_table();
  return table;
}

std::vector<ValueName> wave_value_names(const WaveSignalInfo& signal,
                                        const std::vector<std::string>& kernel_names) {
  if (signal.id != WaveSignal::control_kernel) return signal.value_names;
  std::vector<ValueName> names = {{0, "none"}};
  for (std::size_t i = 0; i < kernel_names.size(); ++i) names.push_back({i + 1, kernel_names[i]});
  return names;
}

std::string wave_signal_markdown() {
  std::string text = "| signal | bits | meaning | values |\n|---|---|---|---|\n";
  for (const WaveSignalInfo& signal : wave_signal_table())
    text += "| `" + signal.path() + "` | " + std::to_string(signal.width) + " | " +
            std::string(signal.meaning) + " | " + values_text(signal) + " |\n";
  return text;
}

}  // namespace model
