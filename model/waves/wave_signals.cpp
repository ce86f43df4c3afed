#include "model/waves/wave_signals.hpp"

#include <algorithm>
#include <array>

#include "firmware/cn/chip/instruction.hpp"
#include "model/observe/control_observer.hpp"

namespace model {
namespace {

using Names = std::vector<ValueName>;

/// Names of an enumeration's values, counted from `first`.
template <class NameOf>
Names names_of(int count, std::uint64_t first, const char* zero, NameOf&& name_of) {
  Names names;
  if (first > 0) names.push_back({0, zero});
  for (int i = 0; i < count; ++i) names.push_back({first + std::uint64_t(i), std::string(name_of(i))});
  return names;
}

Names control_state_names() {
  return names_of(kCycleCauses, 1, "idle",
                  [](int i) { return cycle_cause_name(static_cast<CycleCause>(i)); });
}
Names thread_state_names() {
  return names_of(kThreadStates, 0, "", [](int i) { return thread_state_name(static_cast<ThreadState>(i)); });
}
Names instruction_class_names() {
  return names_of(int(cn::kInstructionClasses), 1, "none",
                  [](int i) { return cn::kInstructionClassNames[std::size_t(i)]; });
}

constexpr auto kBit = WaveForm::bit;
constexpr auto kNumber = WaveForm::number;
constexpr auto kPlot = WaveForm::plot;
constexpr auto kOverview = WaveLevel::overview;
constexpr auto kUnits = WaveLevel::units;
constexpr auto kDetail = WaveLevel::detail;
constexpr auto kChip = WaveCount::chip;
constexpr auto kOther = WaveTopic::other;
constexpr auto kLoad = WaveTopic::load;
constexpr auto kCompute = WaveTopic::compute;
constexpr auto kSave = WaveTopic::save;
constexpr auto kFixed = WaveNames::fixed;

using Rows = std::vector<WaveSignalInfo>;
using Signal = WaveSignal;

void add_bins(Rows& rows) {
  const Names none = {{0, "none"}};
  const Names no_block = {{kNoBlock, "none"}};
  constexpr auto kBins = WaveNames::bins;
  rows.insert(
      rows.end(),
      {{Signal::bins_load_stage, "bins", "load_stage", 8, kNumber, kOverview, kChip, kLoad,
        "stage that the latest mono-to-poly request belongs to, as the firmware names it", kBins, none},
       {Signal::bins_load_block, "bins", "load_block", 16, kNumber, kOverview, kChip, kLoad,
        "block of that stage", kFixed, no_block},
       {Signal::bins_compute_stage, "bins", "compute_stage", 8, kNumber, kOverview, kChip, kCompute,
        "stage that the latest kernel belongs to", kBins, none},
       {Signal::bins_compute_block, "bins", "compute_block", 16, kNumber, kOverview, kChip, kCompute,
        "block of that stage", kFixed, no_block},
       {Signal::bins_save_stage, "bins", "save_stage", 8, kNumber, kOverview, kChip, kSave,
        "stage that the latest poly-to-mono request belongs to", kBins, none},
       {Signal::bins_save_block, "bins", "save_block", 16, kNumber, kOverview, kChip, kSave,
        "block of that stage", kFixed, no_block},
       {Signal::bins_fill, "bins", "fill", 32, kPlot, kOverview, kChip, kOther,
        "slots of all blocks that hold work, as the firmware reports them"}});
}

void add_control(Rows& rows) {
  rows.insert(
      rows.end(),
      {{Signal::control_state, "control", "state", 4, kNumber, kOverview, kChip, kOther,
        "what the control unit spends its cycles on; every cycle has one cause", kFixed,
        control_state_names()},
       {Signal::control_kernel, "control", "kernel", 16, kNumber, kOverview, kChip, kCompute,
        "number of the kernel that runs, in the order in which kernels first ran", WaveNames::kernels,
        Names{{0, "none"}}},
       {Signal::control_semaphore, "control", "semaphore", 8, kNumber, kUnits, kChip, kOther,
        "semaphore that is signalled or waited on", WaveNames::semaphores, Names{{kNoSemaphore, "none"}}},
       {Signal::control_thread, "control.thread", "state", 2, kNumber, kDetail, WaveCount::thread, kOther,
        "what a hardware thread does", kFixed, thread_state_names()}});
}

void add_pe_array(Rows& rows) {
  rows.insert(
      rows.end(),
      {{Signal::pe_array_busy, "pe_array", "busy", 1, kBit, kOverview, kChip, kCompute,
        "1 while a kernel runs, cycles stolen by programmed I/O included"},
       {Signal::pe_array_enabled_pes, "pe_array", "enabled_pes", 11, kPlot, kUnits, kChip, kCompute,
        "PEs that the kernel was started for; 0 between kernels"},
       {Signal::pe_array_instruction_class, "pe_array", "instruction_class", 6, kNumber, kDetail, kChip,
        kCompute,
        "class of instructions that most cycles of the running kernel go to; the model does not order them "
        "within a kernel",
        kFixed, instruction_class_names()}});
}

void add_pio(Rows& rows) {
  const Names no_request = {{kNoRequest, "none"}};
  rows.insert(rows.end(),
              {{Signal::pio_loading, "pio", "loading", 1, kBit, kOverview, kChip, kLoad,
                "1 while a mono-to-poly request is in service, from its setup to its last byte"},
               {Signal::pio_saving, "pio", "saving", 1, kBit, kOverview, kChip, kSave,
                "1 while a poly-to-mono request is in service, from its setup to its last byte"},
               {Signal::pio_queue_depth, "pio", "queue_depth", 16, kPlot, kUnits, kChip, kOther,
                "requests that waited when the latest one started"},
               {Signal::pio_load_request, "pio", "load_request", 32, kNumber, kUnits, kChip, kLoad,
                "id of the mono-to-poly request in service, or of the latest", kFixed, no_request},
               {Signal::pio_load_bytes, "pio", "load_bytes", 32, kNumber, kUnits, kChip, kLoad,
                "bytes that it moves in all PEs"},
               {Signal::pio_save_request, "pio", "save_request", 32, kNumber, kUnits, kChip, kSave,
                "id of the poly-to-mono request in service, or of the latest", kFixed, no_request},
               {Signal::pio_save_bytes, "pio", "save_bytes", 32, kNumber, kUnits, kChip, kSave,
                "bytes that it moves in all PEs"}});
}

void add_memory(Rows& rows) {
  const Names owners = {{0, "idle"}, {1, "pio"}, {2, "control"}, {3, "host"}, {4, "other"}};
  const Names directions = {{0, "idle"}, {1, "read"}, {2, "write"}};
  const Names commands = {{0, "none"}, {1, "activate"}, {2, "read"}, {3, "write"}, {4, "refresh"}};
  rows.insert(
      rows.end(),
      {{Signal::clear_connect_to_ddr, "clear_connect", "to_ddr", 3, kNumber, kDetail, kChip, kOther,
        "whose requests or write data occupy the port to the DDR", kFixed, owners},
       {Signal::clear_connect_from_ddr, "clear_connect", "from_ddr", 3, kNumber, kDetail, kChip, kOther,
        "whose read data occupy the port from the DDR", kFixed, owners},
       {Signal::clear_connect_pio_bytes, "clear_connect", "pio_bytes", 64, kNumber, kUnits, kChip, kOther,
        "bytes so far that crossed the on-chip network for programmed I/O"},
       {Signal::ddr_bus, "ddr", "bus", 2, kNumber, kUnits, kChip, kOther,
        "access that has the data bus, from its first byte to its last, gaps between its pages included",
        kFixed, directions},
       {Signal::ddr_data, "ddr", "data", 2, kNumber, kDetail, kChip, kOther,
        "data on the bus, cycle by cycle", kFixed, directions},
       {Signal::ddr_page_hits, "ddr", "page_hits", 64, kNumber, kDetail, kChip, kOther,
        "accesses to open pages so far; like all counts of memory, updated when a request or cache line is "
        "over"},
       {Signal::ddr_page_misses, "ddr", "page_misses", 64, kNumber, kDetail, kChip, kOther,
        "accesses so far that had to open a page"},
       {Signal::ddr_bytes_read, "ddr", "bytes_read", 64, kNumber, kDetail, kChip, kOther,
        "bytes read so far"},
       {Signal::ddr_bytes_written, "ddr", "bytes_written", 64, kNumber, kDetail, kChip, kOther,
        "bytes written so far"},
       {Signal::ddr_bank_command, "ddr.bank", "command", 3, kNumber, kDetail, WaveCount::bank, kOther,
        "command that the bank got last; an activation includes the precharge before it", kFixed, commands},
       {Signal::ddr_bank_row, "ddr.bank", "row", 32, kNumber, kDetail, WaveCount::bank, kOther,
        "row that was activated last"},
       {Signal::on_chip_sram_port, "on_chip_sram", "port", 2, kNumber, kUnits, kChip, kOther,
        "access that has the port of the on-chip SRAM, from its first byte to its last", kFixed, directions},
       {Signal::search_unit_queries, "search_unit", "queries", 16, kPlot, kUnits, WaveCount::search_unit,
        kCompute, "queries in flight in all search units of the chip, if it has any"},
       {Signal::search_unit_waiting, "search_unit", "waiting", 16, kPlot, kDetail, WaveCount::search_unit,
        kLoad, "of these, queries that wait for lines of mono memory"},
       {Signal::host_link_state, "host_link", "state", 2, kNumber, kUnits, kChip, kOther,
        "what the link to the host does", kFixed, Names{{0, "idle"}, {1, "upload"}, {2, "download"}}}});
}

void add_pes(Rows& rows) {
  rows.insert(rows.end(),
              {{Signal::pe_enabled, "pe_array.pe", "enabled", 1, kBit, kDetail, WaveCount::pe, kCompute,
                "1 while a kernel runs that was started for this PE"},
               {Signal::pe_transfer, "pe_array.pe", "transfer", 2, kNumber, kDetail, WaveCount::pe, kOther,
                "this PE's part in the requests in service: loading + 2 saving", kFixed,
                Names{{0, "none"}, {1, "load"}, {2, "save"}, {3, "both"}}}});
}

Rows make_table() {
  Rows rows;
  add_bins(rows);
  add_control(rows);
  add_pe_array(rows);
  add_pes(rows);
  add_pio(rows);
  add_memory(rows);
  return rows;
}

std::string values_text(const WaveSignalInfo& signal) {
  std::string text;
  for (const ValueName& value : signal.fixed_names)
    text += (text.empty() ? "" : ", ") + std::to_string(value.value) + " " + value.name;
  switch (signal.names) {
    case WaveNames::kernels:
      return text + ", others named by the run's kernels";
    case WaveNames::semaphores:
      return text + ", others named by the firmware's semaphores";
    case WaveNames::bins:
      return text + ", others named by the firmware";
    default:
      return text;
  }
}

/// Whether a chip has at most one, which needs no number.
bool is_single(WaveCount count) {
  return count == WaveCount::chip || count == WaveCount::search_unit;
}

std::string with_number(std::string_view scope, int number, int count) {
  std::string digits = std::to_string(number);
  digits.insert(0, std::to_string(count - 1).size() - digits.size(), '0');
  return std::string(scope) + "_" + digits;
}

}  // namespace

const char* wave_level_name(WaveLevel level) {
  static constexpr std::array<const char*, kWaveLevels> kNames = {"overview", "units", "detail"};
  return kNames.at(std::size_t(level));
}

std::string WaveSignalInfo::path() const {
  return std::string(scope) + (is_single(count) ? "." : "_*.") + std::string(name);
}

const std::vector<WaveSignalInfo>& wave_signal_table() {
  static const std::vector<WaveSignalInfo> table = make_table();
  return table;
}

int wave_count(const ChipConfig& config, WaveCount count) {
  switch (count) {
    case WaveCount::thread:
      return config.control.threads;
    case WaveCount::bank:
      return config.ddr.banks;
    case WaveCount::pe:
      return config.chip.pes;
    case WaveCount::search_unit:
      return config.search_unit.units > 0 ? 1 : 0;
    case WaveCount::chip:
      break;
  }
  return 1;
}

std::vector<WaveInstance> wave_instances(const ChipConfig& config) {
  const std::vector<WaveSignalInfo>& table = wave_signal_table();
  std::vector<WaveInstance> instances;
  for (auto first = table.begin(); first != table.end();) {
    const auto last =
        std::find_if(first, table.end(), [&](const auto& info) { return info.scope != first->scope; });
    const int count = wave_count(config, first->count);
    for (int i = 0; i < count; ++i) {
      const std::string scope =
          is_single(first->count) ? std::string(first->scope) : with_number(first->scope, i, count);
      for (auto info = first; info != last; ++info)
        instances.push_back({&*info, i, scope + "." + std::string(info->name)});
    }
    first = last;
  }
  return instances;
}

std::string wave_name_in_file(const std::string& chip, const WaveInstance& signal) {
  return chip + "." + signal.path;
}

std::string wave_signal_markdown() {
  std::string text = "| signal | bits | level | meaning | values |\n|---|---|---|---|---|\n";
  for (const WaveSignalInfo& signal : wave_signal_table())
    text += "| `" + signal.path() + "` | " + std::to_string(signal.width) + " | " +
            wave_level_name(signal.level) + " | " + std::string(signal.meaning) + " | " +
            values_text(signal) + " |\n";
  return text;
}

}  // namespace model
