#include "testbench/commands/wave_options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "testbench/commands/named_values.hpp"
#include "testbench/observe/wave_files.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& found, const std::string& allowed) {
  throw InputError(option + ": found '" + found + "', allowed is " + allowed);
}

template <class Number>
std::optional<Number> whole_number(const std::string& text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "first:last" as a pair; none without a colon.
std::optional<std::pair<std::string, std::string>> split(const std::string& text, char separator) {
  const std::size_t place = text.find(separator);
  if (place == std::string::npos) return std::nullopt;
  return std::pair(text.substr(0, place), text.substr(place + 1));
}

/// "1700000" cycles or "8.1ms".
std::optional<model::Cycles> cycle_of(const std::string& text, double clock_hz) {
  if (const auto cycles = whole_number<model::Cycles>(text)) return cycles;
  static const std::map<std::string, double> kSecondsPerUnit = {
      {"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const auto unit = kSecondsPerUnit.find(std::string(end, text.data() + text.size()));
  const double cycles = unit == kSecondsPerUnit.end() ? -1 : value * unit->second * clock_hz;
  if (error != std::errc() || !(cycles >= 0 && cycles < 0x1p63)) return std::nullopt;
  return static_cast<model::Cycles>(std::llround(cycles));
}

model::CycleWindow window_of(const std::string& text, double clock_hz) {
  const std::string option = "--waves-window";
  const std::string allowed =
      "FIRST:LAST in cycles, or with a unit of time (s, ms, us, ns); either may be "
      "left out";
  const auto ends = split(text, ':');
  if (!ends) refuse(option, text, allowed);
  model::CycleWindow window;
  const auto set = [&](const std::string& part, model::Cycles& cycle) {
    if (part.empty()) return;
    const auto found = cycle_of(part, clock_hz);
    if (!found) refuse(option, text, allowed);
    cycle = *found;
  };
  set(ends->first, window.first);
  set(ends->second, window.last);
  if (window.first >= window.last) refuse(option, text, "a first cycle below the last");
  return window;
}

model::BlockWindow blocks_of(const std::string& text) {
  const auto ends = split(text, ':');
  model::BlockWindow window;
  const auto first = whole_number<std::uint64_t>(ends ? ends->first : text);
  const auto count = ends ? whole_number<std::uint64_t>(ends->second) : window.count;
  if (!first || !count || *first == 0 || *count == 0)
    refuse("--waves-blocks", text, "FIRST or FIRST:COUNT, the first block is 1");
  return {*first, *count};
}

/// "0,5,90-95".
std::vector<int> pes_of(const std::string& text, int pes) {
  std::vector<int> list;
  const std::string allowed = "PEs or ranges of PEs, as in 0,5,90-95, from 0 to " + std::to_string(pes - 1);
  for (std::string rest = text; !rest.empty();) {
    const auto parts = split(rest, ',');
    const std::string part = parts ? parts->first : rest;
    rest = parts ? parts->second : "";
    if (parts && rest.empty()) refuse("--waves-pes", text, allowed);
    const auto range = split(part, '-');
    const auto first = whole_number<int>(range ? range->first : part);
    const auto last = range ? whole_number<int>(range->second) : first;
    if (!first || !last || *first < 0 || *first > *last || *last >= pes) refuse("--waves-pes", text, allowed);
    for (int pe = *first; pe <= *last; ++pe) list.push_back(pe);
  }
  return list;
}

}  // namespace

void ObservationOption::add_to(CLI::App& command) {
  const std::string group = "Waves and logs";
  command
      .add_option("--waves", waves_,
                  "Write waves (.vcd, or .fst by way of vcd2fst) and a GTKWave view beside them (.gtkw)")
      ->check(error_of_no_file, "")
      ->type_name("FILE")
      ->group(group);
  command
      .add_option("--waves-signals", signals_,
                  "Signals to show, a shell pattern on names as `csx600 waves` lists them; may be repeated")
      ->type_name("PATTERN")
      ->allow_extra_args(false)
      ->group(group);
  std::map<std::string, model::WaveLevel> levels;
  for (int level = 0; level < model::kWaveLevels; ++level)
    levels[model::wave_level_name(static_cast<model::WaveLevel>(level))] =
        static_cast<model::WaveLevel>(level);
  one_of(command.add_option("--waves-level", level_, "How much to show"), levels)
      ->default_str("units; detail with --waves-signals")
      ->group(group);
  command.add_option("--waves-pes", pes_, "PEs to show one by one, as in 0,5,90-95")
      ->type_name("PES")
      ->group(group);
  command
      .add_option("--waves-window", windows_,
                  "Part of the run to show, in cycles or times (8.1ms:9ms); may be repeated")
      ->type_name("FIRST:LAST")
      ->default_str("all")
      ->allow_extra_args(false)
      ->group(group);
  command
      .add_option("--waves-blocks", blocks_,
                  "Part of the run to show, from the FIRST-th block on; may be repeated")
      ->type_name("FIRST[:COUNT]")
      ->allow_extra_args(false)
      ->group(group);
  command
      .add_option("--transactions", transactions_,
                  "Write a line of JSON for each PIO request and host transfer")
      ->check(error_of_no_file, "")
      ->type_name("FILE")
      ->group(group);
  command
      .add_option("--timeline", timeline_,
                  "Write kernels, waits and transfers as trace events (JSON) for Perfetto or about:tracing")
      ->check(error_of_no_file, "")
      ->type_name("FILE")
      ->group(group);
}

std::vector<OutputOption> ObservationOption::outputs() const {
  std::vector<OutputOption> files = {
      {"--waves", waves_}, {"--transactions", transactions_}, {"--timeline", timeline_}};
  if (!waves_.empty())
    for (const std::filesystem::path& file : files_beside_waves(waves_))
      files.emplace_back("--waves (" + file.filename().string() + ")", file.string());
  return files;
}

void ObservationOption::require_waves() const {
  if (!waves_.empty()) return;
  const std::pair<const char*, bool> selecting[] = {{"--waves-signals", !signals_.empty()},
                                                    {"--waves-level", level_.has_value()},
                                                    {"--waves-pes", !pes_.empty()},
                                                    {"--waves-window", !windows_.empty()},
                                                    {"--waves-blocks", !blocks_.empty()}};
  for (const auto& [option, given] : selecting)
    if (given) throw InputError(std::string(option) + ": found without --waves, allowed is together with it");
}

WaveOptions ObservationOption::wave_options(const model::ChipConfig& chip) const {
  WaveOptions waves{waves_, {}};
  waves.config.selection.globs = signals_;
  if (level_) waves.config.selection.level = *level_;
  if (!pes_.empty()) waves.config.selection.pes = pes_of(pes_, chip.chip.pes);
  for (const std::string& text : windows_)
    waves.config.windows.push_back(window_of(text, chip.chip.clock_hz));
  for (const std::string& text : blocks_) waves.config.blocks.push_back(blocks_of(text));
  return waves;
}

ObservationOptions ObservationOption::options(const model::ChipConfig& chip) const {
  require_waves();
  ObservationOptions options;
  options.transactions = transactions_;
  options.timeline = timeline_;
  if (!waves_.empty()) options.waves = wave_options(chip);
  return options;
}

}  // namespace testbench
