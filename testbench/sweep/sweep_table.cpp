#include "testbench/sweep/sweep_table.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <sstream>

#include "testbench/files/csv.hpp"
#include "testbench/run/program_choice.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/sweep/sweep_columns.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

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

/// Results, after the columns that the sweep derives from them.
Json all_results(const Sweep& sweep, const SweepPoint& point, const Json& statistics) {
  Json measured = results_of(statistics);
  const model::ChipConfig& chip = chip_of(point);
  measured["total_sram_bytes"] = std::int64_t{chip.chip.pes} * chip.poly.sram_bytes;
  Json results = Json::object();
  for (const NamedExpression& derived : sweep.expressions().derived)
    if (const auto value = value_of(derived.expression, point, measured); value && std::isfinite(*value))
      results[derived.name] = *value;
  results.update(measured);
  return results;
}

/// "" if it meets all.
std::string unmet_constraint(const Sweep& sweep, const SweepPoint& point, const Json& results) {
  for (const NamedExpression& constraint : sweep.expressions().constraints)
    if (!is_met(value_of(constraint.expression, point, results).value_or(0))) return unmet_text(constraint);
  return "";
}

Json point_json(const Sweep& sweep, const SweepPoint& point, const Json* line, KernelColumns kernels) {
  Json json = {{"inputs", Json::object()}};
  for (std::size_t i = 0; i < point.inputs.size(); ++i)
    json["inputs"][sweep.keys()[i]] = typed(point.inputs[i]);
  if (!point.excluded.empty()) {
    json["status"] = "excluded";
    json["error"] = point.excluded;
    return json;
  }
  json["status"] = line == nullptr ? Json("missing") : (*line)["status"];
  if (line == nullptr) return json;
  if (line->contains("error")) json["error"] = (*line)["error"];
  if (!line->contains("statistics")) return json;
  Json results = all_results(sweep, point, (*line)["statistics"]);
  if (const std::string unmet = unmet_constraint(sweep, point, results); !unmet.empty()) {
    json["status"] = "unmet";
    json["error"] = unmet;
  }
  if (Json chosen = chosen_of(sweep, (*line)["statistics"]); !chosen.empty())
    json["chosen"] = std::move(chosen);
  json["results"] = Json::object();
  for (const auto& [name, value] : results.items())
    if (kernels == KernelColumns::shown || !is_of_kernel(name)) json["results"][name] = value;
  return json;
}

std::string field(const Json& value) {
  return value.is_string() ? csv_text(value.get<std::string>()) : json_text(value);
}

/// The names below a section of the points, each once, in the order in which they come.
/// @param others names of columns that the table has without them: what a point was asked is in its results,
/// too
std::vector<std::string> columns_of(const Json& sweep, const char* section,
                                    const std::vector<std::string>& others) {
  std::vector<std::string> names;
  std::set<std::string> seen(others.begin(), others.end());
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

Json sweep_json(const Sweep& sweep, const PointStore& store, KernelColumns kernels) {
  Json base = Json::object();
  for (const Setting& setting : sweep.base()) base[setting.key] = typed(setting.value);
  Json points = Json::array();
  for (const SweepPoint& point : sweep.points())
    points.push_back(point_json(sweep, point, store.find(point.id), kernels));
  return {{"format", kSweepFormat},
          {"keys", sweep.keys()},
          {"axes", sweep.axes()},
          {"base", base},
          {"points", points}};
}

SweepTables sweep_tables(const Sweep& sweep, const Json& json) {
  const std::vector<std::string> chosen = columns_of(json, "chosen", {});
  const std::vector<std::string> results = columns_of(json, "results", sweep.keys());
  const std::vector<SweepColumn> columns = describe_columns(sweep, chosen, results);
  std::ostringstream csv;
  for (std::size_t i = 0; i < columns.size(); ++i) csv << (i == 0 ? "" : ",") << csv_text(columns[i].name);
  csv << '\n';
  for (const Json& point : json["points"]) {
    for (const auto& [key, value] : point["inputs"].items()) csv << field(value) << ',';
    csv << field(point["status"]) << ',' << (point.contains("error") ? field(point["error"]) : "");
    for (const std::string& name : chosen) csv << ',' << cell(point, "chosen", name);
    for (const std::string& name : results) csv << ',' << cell(point, "results", name);
    csv << '\n';
  }
  return {csv.str(), columns_csv(columns)};
}

}  // namespace testbench
