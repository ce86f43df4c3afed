#include "testbench/sensitivity/sensitivity_table.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "model/config/chip_parameters.hpp"
#include "testbench/files/csv.hpp"
#include "testbench/statistics/json_file.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

/// Below this share a change is no change to people.
constexpr double kLeastShown = 0.0005;
constexpr std::size_t kMostNamed = 5;

constexpr const char* name_of(VariationKind kind) {
  switch (kind) {
    case VariationKind::lower:
      return "lower";
    case VariationKind::higher:
      return "higher";
    case VariationKind::alternative:
      break;
  }
  return "alternative";
}

double change(double from, double to) {
  return from > 0 ? to / from - 1 : 0;
}

/// A parameter with its changed runs, in the order in which they were made.
struct Row {
  const model::ParameterInfo* parameter;
  std::vector<const VariedRun*> runs;
  double effect = 0;  ///< the largest share by which a run's figure changes
};

class Rows {
 public:
  Rows(const Sensitivity& sensitivity, SensitivityOrder order) : sensitivity_(sensitivity), order_(order) {
    for (const VariedRun& run : sensitivity.runs) add(run);
    std::stable_sort(rows.begin(), rows.end(),
                     [](const Row& a, const Row& b) { return a.effect > b.effect; });
  }

  double time_change(const VariedRun& run) const {
    return change(sensitivity_.base.seconds, run.figures.seconds);
  }
  double energy_change(const VariedRun& run) const {
    return change(sensitivity_.base.joules, run.figures.joules);
  }
  /// 0 of a run that failed.
  double change_of(const VariedRun& run) const {
    if (!run.error.empty()) return 0;
    return order_ == SensitivityOrder::time ? time_change(run) : energy_change(run);
  }

  std::vector<Row> rows;

 private:
  void add(const VariedRun& run) {
    if (rows.empty() || rows.back().parameter->key != run.variation.key)
      rows.push_back({model::find_parameter(run.variation.key), {}, 0});
    rows.back().runs.push_back(&run);
    rows.back().effect = std::max(rows.back().effect, std::abs(change_of(run)));
  }

  const Sensitivity& sensitivity_;
  SensitivityOrder order_;
};

std::string value_on(const Sensitivity& sensitivity, const Row& row) {
  const Json::json_pointer place("/chip_config/" + [&] {
    std::string path = row.parameter->key;
    std::replace(path.begin(), path.end(), '.', '/');
    return path;
  }());
  const Json& value = (*sensitivity.statistics)[place];
  return value.is_string() ? value.get<std::string>() : json_text(value);
}

std::string percent(double share) {
  char text[32];
  std::snprintf(text, sizeof(text), "%+.1f %%", 100 * share);
  return text;
}

std::string line(const std::string& key, const std::string& value, const std::string& to,
                 const std::string& time, const std::string& energy) {
  char text[256];
  std::snprintf(text, sizeof(text), "%-40s %-22s %-22s %9s %9s\n", key.c_str(), value.c_str(), to.c_str(),
                time.c_str(), energy.c_str());
  return text;
}

/// The changes that help most, one a parameter.
std::string best_line(const Rows& rows, SensitivityOrder order) {
  std::vector<const VariedRun*> best;
  for (const Row& row : rows.rows) {
    const auto helps_more = [&](const VariedRun* a, const VariedRun* b) {
      return rows.change_of(*a) < rows.change_of(*b);
    };
    const VariedRun* const run = *std::min_element(row.runs.begin(), row.runs.end(), helps_more);
    if (rows.change_of(*run) <= -kLeastShown) best.push_back(run);
  }
  if (best.empty()) return "No change of one parameter helps.\n";
  std::stable_sort(best.begin(), best.end(), [&](const VariedRun* a, const VariedRun* b) {
    return rows.change_of(*a) < rows.change_of(*b);
  });
  best.resize(std::min(best.size(), kMostNamed));
  std::string text;
  for (const VariedRun* const run : best)
    text += (text.empty() ? "" : "; ") + run->variation.key + " = " + run->variation.value + ": " +
            percent(rows.change_of(*run));
  return std::string("Helps most, ") + (order == SensitivityOrder::time ? "time: " : "energy: ") + text +
         '\n';
}

std::string rows_text(const Sensitivity& sensitivity, const Rows& rows, const Row& row) {
  std::string text;
  for (const VariedRun* const run : row.runs) {
    const bool is_first = run == row.runs.front();
    const std::string key = is_first ? row.parameter->key : "";
    const std::string value = is_first ? value_on(sensitivity, row) : "";
    if (run->error.empty())
      text += line(key, value, run->variation.value, percent(rows.time_change(*run)),
                   percent(rows.energy_change(*run)));
    else
      text += line(key, value, run->variation.value, "cannot", "run");
  }
  return text;
}

Json run_json(const Rows& rows, const VariedRun& run) {
  Json json = {{"kind", name_of(run.variation.kind)}, {"value", run.variation.value}};
  if (!run.error.empty()) {
    json["error"] = run.error;
    return json;
  }
  json["cycles"] = run.figures.cycles;
  json["seconds"] = run.figures.seconds;
  json["joules"] = run.figures.joules;
  json["time_change"] = rows.time_change(run);
  json["energy_change"] = rows.energy_change(run);
  return json;
}

}  // namespace

std::string sensitivity_text(const Sensitivity& sensitivity, SensitivityOrder order, int most) {
  const Rows rows(sensitivity, order);
  std::string text = line("parameter", "is", "changed to", "time", "energy");
  int shown = 0;
  for (const Row& row : rows.rows) {
    if (row.effect < kLeastShown || shown == most) break;
    text += rows_text(sensitivity, rows, row);
    ++shown;
  }
  const auto count_if = [&](const auto& is) { return std::count_if(rows.rows.begin(), rows.rows.end(), is); };
  const auto changing = count_if([](const Row& row) { return row.effect >= kLeastShown; });
  const auto failed = std::count_if(sensitivity.runs.begin(), sensitivity.runs.end(),
                                    [](const VariedRun& run) { return !run.error.empty(); });
  text += '\n' + best_line(rows, order);
  text += std::to_string(changing) + " of " + std::to_string(rows.rows.size()) + " parameters change the " +
          (order == SensitivityOrder::time ? "time" : "energy") + " by 0.05 % or more, " +
          std::to_string(shown) + " of them are shown";
  if (failed > 0) text += "; " + std::to_string(failed) + " changed chips cannot run it";
  return text + '\n';
}

std::string sensitivity_csv(const Sensitivity& sensitivity, SensitivityOrder order) {
  const Rows rows(sensitivity, order);
  std::string csv = "key,unit,value,kind,changed_to,cycles,seconds,joules,time_change,energy_change,error\n";
  for (const Row& row : rows.rows)
    for (const VariedRun* const run : row.runs) {
      const std::string head = csv_text(row.parameter->key) + ',' + csv_text(row.parameter->unit) + ',' +
                               value_on(sensitivity, row) + ',' + name_of(run->variation.kind) + ',' +
                               run->variation.value + ',';
      if (!run->error.empty()) {
        csv += head + ",,,,," + csv_text(run->error) + '\n';
        continue;
      }
      csv += head;
      for (const double figure : {run->figures.cycles, run->figures.seconds, run->figures.joules,
                                  rows.time_change(*run), rows.energy_change(*run)})
        csv += json_text(Json(figure)) + ',';
      csv += '\n';
    }
  return csv;
}

Json sensitivity_json(const Sensitivity& sensitivity, SensitivityOrder order) {
  const Rows rows(sensitivity, order);
  Json parameters = Json::array();
  for (const Row& row : rows.rows) {
    Json runs = Json::array();
    for (const VariedRun* const run : row.runs) runs.push_back(run_json(rows, *run));
    parameters.push_back({{"name", row.parameter->key},
                          {"unit", row.parameter->unit},
                          {"value", value_on(sensitivity, row)},
                          {"runs", runs}});
  }
  Json left_out = Json::array();
  for (const LeftOut& left : sensitivity.left_out)
    left_out.push_back({{"name", left.key}, {"reason", left.reason}});
  return {{"share", sensitivity.share},
          {"order", order == SensitivityOrder::time ? "time" : "energy"},
          {"replayed", sensitivity.replayed},
          {"parameters", parameters},
          {"left_out", left_out}};
}

}  // namespace testbench
