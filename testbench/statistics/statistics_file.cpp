#include "testbench/statistics/statistics_file.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>

#include "testbench/statistics/counters.hpp"
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
      Json element = json[i];
      const std::string name = is_named(element) ? element["name"].get<std::string>() : std::to_string(i);
      if (is_named(element)) element.erase("name");
      flatten_into(prefix + name, element, flat);
    }
  } else {
    flat.emplace_back(key, json);
  }
}

bool has(const Json& json, std::string key) {
  std::replace(key.begin(), key.end(), '.', '/');
  return json.contains(Json::json_pointer("/" + key));
}

/// Throws InputError when a counter that every such run has is missing.
void require_counters(const Json& json, const std::string& origin) {
  for (const char* key : {"scene", "firmware", "machine", "chip_preset", "chip_config", "image_sha256"})
    if (!has(json, key))
      throw InputError(origin + ": " + key + ": missing; allowed is a whole statistics file");
  const bool native = json["machine"] == "native";
  for (const Counter& counter : all_counters()) {
    const bool of_chip = counter.key.rfind("chip.", 0) == 0;
    if (counter.key.find('*') != std::string::npos || (native && of_chip)) continue;
    if (!has(json, counter.key))
      throw InputError(origin + ": " + counter.key + ": missing; allowed is a whole statistics file");
  }
}

std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

}  // namespace

FlatStatistics flatten(const Json& statistics) {
  FlatStatistics flat;
  flatten_into("", statistics, flat);
  return flat;
}

void require_statistics_format(const std::string& format, const std::string& origin) {
  if (format == kStatisticsFormat) return;
  const bool is_older = format == "csx600-statistics-1";
  throw InputError(origin + ": format: found '" + format + "', allowed is '" + kStatisticsFormat + "'" +
                   (is_older ? "; an older csx600 wrote it, with other keys: run the render again" : ""));
}

Json read_statistics(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::error_code ignored;
  if (!file || std::filesystem::is_directory(path, ignored))
    throw InputError(path + ": cannot be read; allowed is a statistics file");
  const std::string text{std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  return parse_statistics(text, path);
}

Json parse_statistics(const std::string& text, const std::string& origin) {
  Json json = Json::parse(text, nullptr, false);
  if (json.is_discarded() || !json.is_object())
    throw InputError(origin + ": not a whole JSON object; allowed is a statistics file");
  const std::string format = has(json, "format") ? value_of(json["format"]) : "no format";
  require_statistics_format(format, origin);
  require_current_keys(origin, flatten(json));
  require_counters(json, origin);
  return json;
}

std::string value_of(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
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
    csv += quoted(key) + ',' + (counter == nullptr ? "" : counter->unit) + ',' + quoted(value_of(value)) +
           ',' + (counter == nullptr ? "" : quoted(counter->meaning)) + '\n';
  }
  return csv;
}

std::string statistics_json(const Json& statistics) {
  // The scene's path may be no UTF-8, which costs the path but not the statistics.
  return statistics.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string statistics_for_file(const std::string& path, const Json& statistics) {
  const std::string suffix = std::filesystem::path(path).extension();
  if (suffix == ".csv") return statistics_csv(statistics);
  if (suffix == ".txt") return statistics_text(statistics);
  return statistics_json(statistics);
}

}  // namespace testbench
