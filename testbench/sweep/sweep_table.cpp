#include "testbench/sweep/sweep_table.hpp"

#include <algorithm>
#include <set>
#include <sstream>

#include "testbench/files/csv.hpp"
#include "testbench/run/program_choice.hpp"
#include "testbench/statistics/json_file.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// A distribution is a list of numbers, or counts by number.
bool is_distribution(const Json& json) {
  const auto by_number = [](const auto& entry) {
    return entry.key().find_first_not_of("0123456789") == std::string::npos && entry.value().is_number();
  };
  const auto entries = json.items();
  return !json.empty() && std::all_of(entries.begin(), entries.end(), by_number);
}

/// The numbers below `json`, each under its path. Entries of lists go by their name; distributions and how
/// often each instruction was issued stay in the statistics.
void add_numbers(const Json& json, const std::string& path, Json& results) {
  if (json.is_number()) {
    results[path] = json;
    return;
  }
  if (!json.is_structured() || is_distribution(json)) return;
  for (const auto& [key, value] : json.items()) {
    if (key == "issued") continue;
    const std::string name = json.is_array() && value.is_object() && value.contains("name")
                                 ? value["name"].get<std::string>()
                                 : std::string(key);
    std::string path_of_value = path;
    if (!path.empty()) path_of_value += '.';
    path_of_value += name;
    add_numbers(value, path_of_value, results);
  }
}

double number(const Json& json, const char* pointer) {
  const Json::json_pointer place(pointer);
  return json.contains(place) && json[place].is_number() ? json[place].get<double>() : 0;
}

/// What people look for first, from the counts of one run.
Json headline(const Json& statistics) {
  const double seconds = number(statistics, "/simulated_seconds");
  const double cycles = number(statistics, "/simulated_cycles");
  const auto ratio = [](double a, double b) { return b > 0 ? a / b : 0; };
  const double pio_bytes =
      number(statistics, "/chip/pio/bytes_mono_to_poly") + number(statistics, "/chip/pio/bytes_poly_to_mono");
  const double ddr_bytes =
      number(statistics, "/chip/ddr/bytes_read") + number(statistics, "/chip/ddr/bytes_written");
  Json line = {{"simulated_cycles", statistics["simulated_cycles"]}, {"simulated_seconds", seconds}};
  const bool is_render = statistics.contains("rays");
  if (is_render) {
    line["segments_per_second"] = ratio(number(statistics, "/segments"), seconds);
    line["rays_per_second"] = ratio(number(statistics, "/rays"), seconds);
  }
  line["pio_utilisation"] = ratio(number(statistics, "/chip/pio/busy_cycles"), cycles);
  line["ddr_utilisation"] = ratio(number(statistics, "/chip/ddr/busy_cycles"), cycles);
  if (is_render) {
    line["pio_bytes_per_ray"] = ratio(pio_bytes, number(statistics, "/rays"));
    line["ddr_bytes_per_ray"] = ratio(ddr_bytes, number(statistics, "/rays"));
  }
  return line;
}

/// The counters of a firmware outside this tree, under their names.
void add_own_counters(const Json& statistics, Json& results) {
  const Json::json_pointer place("/firmware/counters");
  if (!statistics.contains(place)) return;
  for (const Json& counter : statistics[place])
    results["firmware." + counter["name"].get<std::string>()] = counter["value"];
}

Json results_of(const Json& statistics) {
  Json results = headline(statistics);
  add_own_counters(statistics, results);
  Json inputs_left_out = statistics;
  for (const char* const input : {"width", "height", "firmware", "chip_config"}) inputs_left_out.erase(input);
  add_numbers(inputs_left_out, "", results);
  return results;
}

/// The options of the firmware that the sweep left to choose_program(), as it chose them.
Json chosen_of(const Sweep& sweep, const Json& statistics) {
  Json chosen = Json::object();
  if (!statistics.contains("rays")) return chosen;
  const auto& keys = sweep.keys();
  for (const char* const name : kChosenOptions) {
    const std::string key = std::string("firmware.") + name;
    const bool is_on_axis = std::find(keys.begin(), keys.end(), key) != keys.end();
    const bool is_in_base = std::any_of(sweep.base().begin(), sweep.base().end(),
                                        [&](const Setting& setting) { return setting.key == key; });
    if (!is_on_axis && !is_in_base) chosen[key] = statistics["firmware"][name];
  }
  return chosen;
}

Json point_json(const Sweep& sweep, const SweepPoint& point, const Json* line) {
  Json json = {{"inputs", Json::object()}};
  for (std::size_t i = 0; i < point.inputs.size(); ++i)
    json["inputs"][sweep.keys()[i]] = typed(point.inputs[i]);
  json["status"] = line == nullptr ? Json("missing") : (*line)["status"];
  if (line == nullptr) return json;
  if (line->contains("error")) json["error"] = (*line)["error"];
  if (!line->contains("statistics")) return json;
  if (Json chosen = chosen_of(sweep, (*line)["statistics"]); !chosen.empty())
    json["chosen"] = std::move(chosen);
  const model::ChipConfig& chip = chip_of(point);
  json["results"] = results_of((*line)["statistics"]);
  json["results"]["total_sram_bytes"] = std::int64_t{chip.chip.pes} * chip.poly.sram_bytes;
  return json;
}

std::string field(const Json& value) {
  return value.is_string() ? csv_text(value.get<std::string>()) : json_text(value);
}

/// The names below a section of the points, each once, in the order in which they come.
std::vector<std::string> columns_of(const Json& sweep, const char* section) {
  std::vector<std::string> names;
  std::set<std::string> seen;
  for (const Json& point : sweep["points"])
    if (point.contains(section))
      for (const auto& [name, value] : point[section].items())
        if (seen.insert(name).second) names.push_back(name);
  return names;
}

/// "" where the point has none.
std::string cell(const Json& point, const char* section, const std::string& name) {
  return point.contains(section) && point[section].contains(name) ? field(point[section][name]) : "";
}

}  // namespace

Json typed(const std::string& value) {
  Json json = Json::parse(value, nullptr, false);
  return json.is_number() || json.is_boolean() ? json : Json(value);
}

Json sweep_json(const Sweep& sweep, const PointStore& store) {
  Json base = Json::object();
  for (const Setting& setting : sweep.base()) base[setting.key] = typed(setting.value);
  Json points = Json::array();
  for (const SweepPoint& point : sweep.points())
    points.push_back(point_json(sweep, point, store.find(point.id)));
  return {{"format", kSweepFormat},
          {"keys", sweep.keys()},
          {"axes", sweep.axes()},
          {"base", base},
          {"points", points}};
}

std::string sweep_csv(const Json& sweep) {
  const std::vector<std::string> chosen = columns_of(sweep, "chosen");
  const std::vector<std::string> names = columns_of(sweep, "results");
  std::ostringstream csv;
  for (const Json& key : sweep["keys"]) csv << field(key) << ',';
  csv << "status,error";
  for (const std::string& name : chosen) csv << ',' << field(name);
  for (const std::string& name : names) csv << ',' << field(name);
  csv << '\n';
  for (const Json& point : sweep["points"]) {
    for (const auto& [key, value] : point["inputs"].items()) csv << field(value) << ',';
    csv << field(point["status"]) << ',' << (point.contains("error") ? field(point["error"]) : "");
    for (const std::string& name : chosen) csv << ',' << cell(point, "chosen", name);
    for (const std::string& name : names) csv << ',' << cell(point, "results", name);
    csv << '\n';
  }
  return csv.str();
}

}  // namespace testbench
