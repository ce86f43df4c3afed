#include "testbench/sweep/sweep_columns.hpp"

#include <algorithm>
#include <sstream>

#include "testbench/files/csv.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/nearest_name.hpp"

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

double ratio(double a, double b) {
  return b > 0 ? a / b : 0;
}

double seconds(const Json& run) {
  return number(run, "/simulated_seconds");
}
double rays(const Json& run) {
  return number(run, "/rays");
}
double pio_bytes(const Json& run) {
  return number(run, "/chip/pio/bytes_mono_to_poly") + number(run, "/chip/pio/bytes_poly_to_mono");
}
double ddr_bytes(const Json& run) {
  return number(run, "/chip/ddr/bytes_read") + number(run, "/chip/ddr/bytes_written");
}
double busy_share(const Json& run, const char* busy_cycles) {
  return ratio(number(run, busy_cycles), number(run, "/simulated_cycles"));
}

/// A result that is made of a run's counts.
struct Headline {
  const char* name;
  const char* unit;
  const char* meaning;
  bool is_of_renders;
  double (*value)(const Json& statistics);
};

/// What people look for first; the only list of it.
constexpr Headline kHeadlines[] = {
    {"segments_per_second", "1/s", "segments by simulated_seconds", true,
     [](const Json& run) { return ratio(number(run, "/segments"), seconds(run)); }},
    {"rays_per_second", "1/s", "rays by simulated_seconds", true,
     [](const Json& run) { return ratio(rays(run), seconds(run)); }},
    {"pio_utilisation", "-", "share of the time that programmed I/O is busy", false,
     [](const Json& run) { return busy_share(run, "/chip/pio/busy_cycles"); }},
    {"ddr_utilisation", "-", "share of the time that the DDR's data bus is busy", false,
     [](const Json& run) { return busy_share(run, "/chip/ddr/busy_cycles"); }},
    {"pio_bytes_per_ray", "bytes", "bytes of programmed I/O, both ways, for each ray", true,
     [](const Json& run) { return ratio(pio_bytes(run), rays(run)); }},
    {"ddr_bytes_per_ray", "bytes", "bytes read from and written to the DDR for each ray", true,
     [](const Json& run) { return ratio(ddr_bytes(run), rays(run)); }}};

constexpr const char* kTotalSram = "total_sram_bytes";

const Headline* find_headline(const std::string& name) {
  const auto found = std::find_if(std::begin(kHeadlines), std::end(kHeadlines),
                                  [&](const Headline& headline) { return headline.name == name; });
  return found != std::end(kHeadlines) ? &*found : nullptr;
}

/// The counters of a firmware outside this tree, under their names.
void add_own_counters(const Json& statistics, Json& results) {
  const Json::json_pointer place("/firmware/counters");
  if (!statistics.contains(place)) return;
  for (const Json& counter : statistics[place])
    results["firmware." + counter["name"].get<std::string>()] = counter["value"];
}

bool is_result(const Sweep& sweep, const std::string& name) {
  const bool is_own = !sweep.firmware_builds().empty() && name.rfind("firmware.", 0) == 0;
  return is_own || name == kTotalSram || find_headline(name) != nullptr || find_counter(name) != nullptr;
}

std::vector<std::string> known_names(const Sweep& sweep) {
  std::vector<std::string> names = sweep.keys();
  for (const Headline& headline : kHeadlines) names.emplace_back(headline.name);
  for (const Counter& counter : all_counters()) names.push_back(counter.key);
  for (const model::ParameterInfo& parameter : model::parameter_table()) names.push_back(parameter.key);
  return names;
}

void require_names(const Sweep& sweep, const NamedExpression& named) {
  for (const std::string& name : named.expression.names()) {
    if (sweep.is_parameter(name) || is_result(sweep, name)) continue;
    const std::string nearest = nearest_name(name, known_names(sweep));
    throw InputError(named.expression.origin() + ": found '" + name +
                     "'; allowed: parameters of the chip, keys that the sweep sets, and results" +
                     (nearest.empty() ? "" : "; did you mean '" + nearest + "'?"));
  }
}

SweepColumn describe_parameter(const std::string& key, const char* section) {
  if (const model::ParameterInfo* const parameter = model::find_parameter(key))
    return {key, section, parameter->unit, parameter->meaning};
  if (const RunParameter* const parameter = find_run_parameter(key))
    return {key, section, "-", "parameter of the run: " + parameter->allowed};
  return {key, section, "-", "option of the firmware"};
}

SweepColumn describe_result(const Sweep& sweep, const std::string& name) {
  for (const NamedExpression& derived : sweep.expressions().derived)
    if (derived.name == name) return {name, "derived", derived.unit, derived.expression.text()};
  if (const Headline* const headline = find_headline(name))
    return {name, "result", headline->unit, headline->meaning};
  if (name == kTotalSram) return {name, "result", "bytes", "SRAM of all PEs: chip.pes times poly.sram_bytes"};
  if (const Counter* const counter = find_counter(name))
    return {name, "result", counter->unit, counter->meaning};
  return {name, "result", "-", "counter of the firmware's own"};
}

}  // namespace

Json results_of(const Json& statistics) {
  Json results = {{"simulated_cycles", statistics["simulated_cycles"]},
                  {"simulated_seconds", seconds(statistics)}};
  const bool is_render = statistics.contains("rays");
  for (const Headline& headline : kHeadlines)
    if (is_render || !headline.is_of_renders) results[headline.name] = headline.value(statistics);
  add_own_counters(statistics, results);
  Json inputs_left_out = statistics;
  for (const char* const input : {"width", "height", "firmware", "chip_config"}) inputs_left_out.erase(input);
  add_numbers(inputs_left_out, "", results);
  return results;
}

bool is_of_kernel(const std::string& result) {
  return result.find(".pe_array.kernels.") != std::string::npos;
}

void require_columns(const Sweep& sweep) {
  const auto& [constraints, derived] = sweep.expressions();
  for (const NamedExpression& constraint : constraints) require_names(sweep, constraint);
  for (const NamedExpression& column : derived) {
    require_names(sweep, column);
    if (is_result(sweep, column.name) || is_setting(column.name))
      throw InputError(column.expression.origin() + ": found the name of a " +
                       (is_setting(column.name) ? "parameter" : "result") + "; allowed: a name of its own");
  }
}

std::vector<SweepColumn> describe_columns(const Sweep& sweep, const std::vector<std::string>& chosen,
                                          const std::vector<std::string>& results) {
  std::vector<SweepColumn> columns;
  for (const std::string& key : sweep.keys()) columns.push_back(describe_parameter(key, "input"));
  columns.push_back(
      {"status", "status", "-",
       "done; failed; missing: not run yet; excluded: not run, since a constraint over parameters is "
       "not met; unmet: run, but a constraint over results is not met"});
  columns.push_back({"error", "status", "-", "why it failed, or the constraint that is not met"});
  for (const std::string& key : chosen) columns.push_back(describe_parameter(key, "chosen"));
  for (const std::string& name : results) columns.push_back(describe_result(sweep, name));
  return columns;
}

std::string columns_csv(const std::vector<SweepColumn>& columns) {
  std::ostringstream csv;
  csv << "column,section,unit,meaning\n";
  for (const SweepColumn& column : columns)
    csv << csv_text(column.name) << ',' << column.section << ','
        << (column.unit == "-" ? "" : csv_text(column.unit)) << ',' << csv_text(column.meaning) << '\n';
  return csv.str();
}

}  // namespace testbench
