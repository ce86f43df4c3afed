#include "testbench/statistics/statistics_file.hpp"

#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <sstream>

#include "testbench/files/csv.hpp"
#include "testbench/files/input_file.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/statistics/renamed_keys.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

bool is_named(const Json& json) {
  return json.is_object() && json.contains("name") && json["name"].is_string();
}

void flatten_into(const std::string& key, const Json& json, FlatStatistics& flat) {
  const std::string prefix = key.empty() ? "" : key + ".";
  if (json.is_object()) {
    for (const auto& [name, value] : json.items()) flatten_into(prefix + name, value, flat);
  } else if (json.is_array()) {
    for (std::size_t i = 0; i < json.size(); ++i) {
      const Json& element = json[i];
      if (!is_named(element)) {
        flatten_into(prefix + std::to_string(i), element, flat);
        continue;
      }
      const std::string of_element = prefix + element["name"].get<std::string>() + '.';
      for (const auto& [name, value] : element.items())
        if (name != "name") flatten_into(of_element + name, value, flat);
    }
  } else {
    flat.emplace_back(key, json);
  }
}

bool has(const Json& json, std::string key) {
  std::replace(key.begin(), key.end(), '.', '/');
  return json.contains(Json::json_pointer("/" + key));
}

bool is_of_plug_in(const Json& json) {
  return json.contains("format") && json["format"] == kRunStatisticsFormat;
}

void require_key(const Json& json, const std::string& key, const std::string& origin) {
  if (!has(json, key))
    throw InputError(origin + ": " + key + ": missing; allowed is a whole statistics file");
}

/// Throws InputError when a counter that every such run has is missing.
void require_counters(const Json& json, const std::string& origin, bool with_simulator) {
  const bool of_plug_in = is_of_plug_in(json);
  for (const std::string key : {"scene", "firmware", "machine", "chip_preset", "chip_config", "image_sha256"})
    if (!of_plug_in || (key != "scene" && key != "image_sha256")) require_key(json, key, origin);
  const bool native = json["machine"] == "native";
  for (const Counter& counter : all_counters()) {
    const bool of_chip = counter.key.rfind("chip.", 0) == 0;
    const bool of_simulator = counter.key.rfind(std::string(kSimulatorSection) + ".", 0) == 0;
    if (counter.key.find('*') != std::string::npos || (native && of_chip)) continue;
    if ((of_simulator && !with_simulator) || (of_plug_in && !of_chip)) continue;
    require_key(json, counter.key, origin);
  }
}

/// What the values of a statistics file may be, beside the counters'.
const Schema& run_schema() {
  static const Schema schema = {
      {"format", JsonType::text},
      {"scene", JsonType::text},
      {"width", JsonType::count},
      {"height", JsonType::count},
      {"triangles", JsonType::count, false},
      {"firmware", JsonType::object},
      {"firmware.samples", JsonType::count},
      {"firmware.*", JsonType::scalar},
      {"machine", JsonType::text},
      {"timing", JsonType::text},
      {"chip_preset", JsonType::text},
      {"chip_config", JsonType::object},
      {"image_sha256", JsonType::text},
      {"counts", JsonType::object},
      {"segments", JsonType::count},
      {"rays", JsonType::count},
  };
  return schema;
}

/// The same of a firmware outside this tree.
const Schema& plug_in_schema() {
  static const Schema schema = {
      {"format", JsonType::text},
      {"firmware", JsonType::object},
      {"firmware.name", JsonType::text},
      {"firmware.options", JsonType::object},
      {"firmware.options.*", JsonType::scalar, false},
      {"firmware.counters", JsonType::list},
      {"firmware.counters.*.name", JsonType::text},
      {"firmware.counters.*.value", JsonType::number_or_none},
      {"firmware.counters.*.unit", JsonType::text},
      {"firmware.counters.*.meaning", JsonType::text},
      {"work", JsonType::object, false},
      {"machine", JsonType::text},
      {"timing", JsonType::text},
      {"chip_preset", JsonType::text},
      {"chip_config", JsonType::object},
  };
  return schema;
}

/// The same of a run on the chip.
const Schema& chip_schema() {
  static const Schema schema = {
      {"simulated_cycles", JsonType::count},
      {"simulated_seconds", JsonType::number},
      {"chip.control_unit.cycles_by_cause.*", JsonType::count},
      {"chip.pe_array.kernels", JsonType::list},
      {"chip.pe_array.kernels.*.name", JsonType::text},
      {"chip.pe_array.kernels.*.cycles", JsonType::count},
      {"chip.pe_array.kernels.*.issued.*", JsonType::number},
      {"chip.pe_array.kernels.*.runs_by_enabled_pes.*", JsonType::count},
  };
  return schema;
}

/// What `csx600 sensitivity` adds to a run's.
const Schema& sensitivity_schema() {
  static const Schema schema = {
      {"sensitivity.order", JsonType::text, false},
      {"sensitivity.parameters.*.name", JsonType::text, false},
      {"sensitivity.parameters.*.value", JsonType::text, false},
      {"sensitivity.parameters.*.runs.*.kind", JsonType::text, false},
      {"sensitivity.parameters.*.runs.*.value", JsonType::text, false},
      {"sensitivity.parameters.*.runs.*.time_change", JsonType::number, false},
      {"sensitivity.parameters.*.runs.*.energy_change", JsonType::number, false},
  };
  return schema;
}

/// Every counter that is there is a number; some that are derived are names.
Schema counter_schema() {
  Schema schema;
  for (const std::vector<Counter>* const counters : {&all_counters(), &all_work_counters()})
    for (const Counter& counter : *counters)
      schema.push_back({counter.key,
                        counter.kind == CounterKind::counted ? JsonType::number_or_none : JsonType::scalar,
                        false});
  return schema;
}

/// Throws InputError for a value of another type than the schemas say.
void require_statistics_types(const Json& json, const std::string& text, const std::string& origin) {
  require_schema(json, is_of_plug_in(json) ? plug_in_schema() : run_schema(), text, origin);
  if (json["machine"] != "native") require_schema(json, chip_schema(), text, origin);
  require_schema(json, sensitivity_schema(), text, origin);
  static const Schema counters = counter_schema();
  require_schema(json, counters, text, origin);
}

constexpr const char* kStatisticsFile = "a statistics file";
constexpr std::uint64_t kMostStatisticsBytes = std::uint64_t{1} << 26;

}  // namespace

FlatStatistics flatten(const Json& statistics) {
  FlatStatistics flat;
  flatten_into("", statistics, flat);
  return flat;
}

void require_statistics_format(const std::string& format, const std::string& origin) {
  if (format == kStatisticsFormat || format == kRunStatisticsFormat) return;
  const bool is_older = format == "csx600-statistics-1";
  throw InputError(origin + ": format: found '" + format + "', allowed is '" + kStatisticsFormat + "' or '" +
                   kRunStatisticsFormat + "'" +
                   (is_older ? "; an older csx600 wrote it, with other keys: run the render again" : ""));
}

Json read_statistics(const std::string& path) {
  return parse_statistics(read_input_file(path, kStatisticsFile, kMostStatisticsBytes), path);
}

Json parse_statistics(const std::string& text, const std::string& origin) {
  Json json = parse_json_object(text, origin, kStatisticsFile);
  const std::string format = has(json, "format") ? value_of(json["format"]) : "no format";
  require_statistics_format(format, origin);
  require_current_keys(origin, flatten(json));
  require_counters(json, origin, json.contains(kSimulatorSection));
  require_statistics_types(json, text, origin);
  return json;
}

void require_point_statistics(const Json& json, const std::string& origin) {
  require_counters(json, origin, false);
  require_statistics_types(json, "", origin);
}

std::string value_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : json_text(value);
}

std::string unit_of(const std::string& key) {
  const Counter* const counter = find_counter(key);
  return counter == nullptr ? "" : counter->unit;
}

std::string group_of(const std::string& key) {
  const std::size_t dot = key.rfind('.');
  return dot == std::string::npos ? "run" : key.substr(0, dot);
}

std::string name_of(const std::string& key) {
  return key.substr(key.rfind('.') + 1);
}

std::string statistics_text(const Json& statistics) {
  const FlatStatistics flat = grouped(flatten(statistics));
  std::size_t width = 0;
  for (const auto& [key, value] : flat) width = std::max(width, name_of(key).size());
  std::ostringstream out;
  std::string group;
  for (const auto& [key, value] : flat) {
    if (group_of(key) != group) out << (group.empty() ? "" : "\n") << (group = group_of(key)) << '\n';
    const std::string unit = unit_of(key);
    out << "  " << std::left << std::setw(int(width) + 2) << name_of(key) << value_of(value)
        << (unit == "-" || unit.empty() || unit == "count" ? "" : " " + unit) << '\n';
  }
  return out.str();
}

std::string statistics_csv(const Json& statistics) {
  std::string csv = "key,unit,value,meaning\n";
  for (const auto& [key, value] : flatten(statistics)) {
    const Counter* const counter = find_counter(key);
    const std::string field = value.is_string() ? csv_text(value.get<std::string>()) : json_text(value);
    csv += csv_text(key) + ',' + (counter == nullptr ? "" : counter->unit) + ',' + field + ',' +
           (counter == nullptr ? "" : csv_text(counter->meaning)) + '\n';
  }
  return csv;
}

std::string statistics_json(const Json& statistics) {
  // The scene's path may be no UTF-8, which costs the path but not the statistics.
  return json_text(statistics, 2) + "\n";
}

std::string statistics_for_file(const std::string& path, const Json& statistics) {
  const std::string suffix = std::filesystem::path(path).extension();
  if (suffix == ".csv") return statistics_csv(statistics);
  if (suffix == ".txt") return statistics_text(statistics);
  return statistics_json(statistics);
}

}  // namespace testbench
