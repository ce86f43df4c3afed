#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "testbench/plug_in/plug_in_run.hpp"
#include "testbench/run/energy.hpp"
#include "testbench/run/timing_name.hpp"
#include "testbench/statistics/chip_config_json.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/statistics/verdict.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

std::string formatted(const char* format, double value) {
  char buffer[64];
  std::snprintf(buffer, sizeof(buffer), format, value);
  return buffer;
}

/// Each with its unit and meaning, since no table of this program has them.
Json counters_json(const plug_in::Firmware& firmware) {
  Json json = Json::array();
  for (const plug_in::Counter* const counter : firmware.counters())
    json.push_back({{"name", counter->name()},
                    {"value", counter->value()},
                    {"unit", counter->unit()},
                    {"meaning", counter->meaning()}});
  return json;
}

Json options_json(const plug_in::Firmware& firmware) {
  Json json = Json::object();
  for (const plug_in::OptionBase* const option : firmware.options())
    json[option->name()] = Json::parse(option->value_text());
  return json;
}

}  // namespace

Json plug_in_statistics(const plug_in::Firmware& firmware, const PlugInOptions& options,
                        const PlugInResult& result) {
  Json json;
  json["format"] = kRunStatisticsFormat;
  json["firmware"] = {
      {"name", firmware.name()}, {"options", options_json(firmware)}, {"counters", counters_json(firmware)}};
  json["machine"] = options.native ? "native" : "chip";
  json["timing"] = options.native ? "none" : timing_name(options.timing);
  json["chip_preset"] = options.chip.preset;
  json["chip_config"] = chip_config_json(options.chip);
  if (const plug_in::Work work = firmware.work(); work.amount > 0) {
    json["work"] = Json::object();
    write_counters(work_counters(), WorkDone{work.amount, work.unit, result.chip ? &*result.chip : nullptr},
                   json["work"]);
  }
  if (!result.chip) return json;
  json["simulated_cycles"] = result.chip->firmware_cycles;
  json["simulated_seconds"] = result.chip->seconds();
  json["chip"] = to_json(*result.chip);
  return json;
}

std::string plug_in_table(const plug_in::Firmware& firmware, const PlugInResult& result) {
  std::string table = firmware.name() + ": results are right\n";
  const auto row = [&](const std::string& name, const std::string& value) {
    constexpr std::size_t kColumn = 24;
    const std::string gap(kColumn - std::min(kColumn - 2, name.size()), ' ');
    table += "  " + name + gap + value + "\n";
  };
  for (const plug_in::Counter* const counter : firmware.counters()) {
    const bool has_unit = counter->unit() != "-" && counter->unit() != "count";
    row(counter->name(), formatted("%.6g", counter->value()) + (has_unit ? " " + counter->unit() : ""));
  }
  if (!result.chip) return table;
  const ChipStatistics& chip = *result.chip;
  row("simulated time",
      formatted("%.6f s", chip.seconds()) + formatted(" (%.0f cycles)", double(chip.firmware_cycles)));
  row("with upload, download", formatted("%.6f s", chip.total_seconds()));
  if (const plug_in::Work work = firmware.work(); work.amount > 0) {
    row(work.unit + "/s",
        formatted("%.6g", work.amount / chip.seconds()) +
            formatted(", %.6g with upload and download", work.amount / chip.total_seconds()));
  }
  row("PE utilisation", formatted("%.2f %%", 100 * chip.pe_utilisation()));
  row("SIMD efficiency", formatted("%.2f %%", 100 * chip.simd_efficiency()));
  row("exposed PIO", formatted("%.2f %% of the time", 100 * chip.exposed_pio_share()));
  row("DDR bandwidth", formatted("%.1f MB/s", chip.ddr_bytes_per_second() * 1e-6));
  row("energy", formatted("%.4g J", energy_of(chip).joules()));
  row("verdict", verdict_of(chip).reason);
  return table;
}

}  // namespace testbench
