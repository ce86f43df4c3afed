#include "testbench/golden/golden.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <memory>
#include <set>
#include <sstream>

#include "testbench/files/atomic_file.hpp"
#include "testbench/files/input_file.hpp"
#include "testbench/mono_image/scene_features.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/statistics/renamed_keys.hpp"
#include "testbench/statistics/render_report.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/message_text.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// Of a board its sums: they move when a chip's counters do.
bool is_kept(const std::string& key) {
  if (key == "image_sha256") return true;
  if (key.rfind("chips.", 0) == 0) return false;
  constexpr const char* kOwnCounters = "firmware.counters.";
  if (key.rfind(kOwnCounters, 0) == 0 && name_of(key) == "value") return true;
  const Counter* const counter = find_counter(key);
  return counter != nullptr && counter->kind == CounterKind::counted && group_of(key) != kSimulatorSection;
}

Json statistics_of(const PlugInSettings& run) {
  const std::unique_ptr<plug_in::Firmware> firmware = run.make_firmware();
  const PlugInResult result = run_plug_in(*firmware, run.options);
  return plug_in_statistics(*firmware, run.options, result);
}

Json statistics_of(const GoldenRun& run, const Scene& scene) {
  RenderOptions options = run.options;
  options.program = built_for(scene, options.program);
  choose_tree(TriangleCount(scene), options.chip, run.given, options.program);
  const RenderResult result = render_on_chip(scene, options);
  return render_statistics({run.scene, options, false}, result);
}

FlatStatistics kept_of(const GoldenRun& run, const GoldenScenes& scenes) {
  FlatStatistics kept;
  for (auto& value :
       flatten(run.plug_in ? statistics_of(*run.plug_in) : statistics_of(run, scenes.at(run.scene))))
    if (is_kept(value.first)) kept.push_back(std::move(value));
  return kept;
}

std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  if (!line.empty() && line.back() == ',') cells.emplace_back();
  return cells;
}

/// A hash is text, a counter is a number. Throws InputError for anything else.
Json value_of_cell(const std::string& key, const std::string& cell, const std::string& place) {
  const bool is_hash = key == "image_sha256";
  constexpr std::size_t kHashDigits = 64;
  if (is_hash && cell.size() == kHashDigits &&
      cell.find_first_not_of("0123456789abcdef") == std::string::npos)
    return cell;
  const bool may_be_number = cell.find_first_not_of("0123456789+-.eE") == std::string::npos;
  Json value = may_be_number && !is_hash ? Json::parse(cell, nullptr, false) : Json();
  if (value.is_number()) return value;
  throw InputError(place + ": " + key + ": found '" + cell.substr(0, 40) +
                   "'; allowed: " + (is_hash ? "64 hexadecimal digits" : "a number"));
}

GoldenTable read_table(const fs::path& path) {
  std::istringstream file(read_input_file(path, "a table of golden runs"));
  std::string line;
  if (!std::getline(file, line) || line.rfind("key,", 0) != 0)
    throw InputError(path.string() +
                     ": not a table of golden runs; write it anew with csx600 golden --update");
  GoldenTable table;
  std::set<std::string> keys;
  std::vector<std::vector<std::string>> rows;
  const std::vector<std::string> names = cells_of(line);
  for (std::size_t i = 1; i < names.size(); ++i) table.push_back({names[i], {}});
  while (std::getline(file, line)) {
    rows.push_back(cells_of(line));
    if (rows.back().size() != names.size())
      throw InputError(path.string() + ":" + std::to_string(rows.size() + 1) + ": found " +
                       std::to_string(rows.back().size()) + " cells, allowed are " +
                       std::to_string(names.size()));
  }
  for (std::size_t row = 0; row < rows.size(); ++row) {
    const std::vector<std::string>& cells = rows[row];
    const std::string place = path.string() + ":" + std::to_string(row + 2);
    require_current_key(place, cells[0]);
    if (!keys.insert(cells[0]).second)
      throw InputError(place + ": " + cells[0] + ": found a second row; allowed: one a counter");
    for (std::size_t i = 1; i < cells.size(); ++i)
      if (!cells[i].empty())
        table[i - 1].second.emplace_back(cells[0], value_of_cell(cells[0], cells[i], place));
  }
  return table;
}

/// Keys of all runs: those that only some have follow the key that they follow there.
std::vector<std::string> keys_of(const GoldenTable& table) {
  std::vector<std::string> keys;
  std::set<std::string> known;
  for (const auto& [name, values] : table) {
    std::size_t place = 0;
    for (const auto& [key, value] : values) {
      if (known.insert(key).second) {
        keys.insert(keys.begin() + std::ptrdiff_t(place++), key);
      } else {
        place = std::size_t(std::find(keys.begin(), keys.end(), key) - keys.begin()) + 1;
      }
    }
  }
  return keys;
}

std::string table_csv(const GoldenTable& table) {
  std::string csv = "key";
  std::vector<std::map<std::string, Json>> columns;
  for (const auto& [name, values] : table) {
    csv += ',' + name;
    columns.emplace_back(values.begin(), values.end());
  }
  csv += '\n';
  for (const std::string& key : keys_of(table)) {
    csv += key;
    for (const auto& column : columns) {
      const auto found = column.find(key);
      csv += ',' + (found == column.end() ? "" : value_of(found->second));
    }
    csv += '\n';
  }
  return csv;
}

/// How one counter moved over the runs.
struct Move {
  int runs = 0;
  std::optional<double> least;     ///< relative difference; none where a value is missing or no number
  std::optional<double> greatest;  ///< likewise
  Difference first;
  std::string first_run;

  void add(const Difference& difference, const std::string& run) {
    if (runs++ == 0) first = difference, first_run = run;
    if (const std::optional<double> relative = difference.relative()) {
      least = std::min(least.value_or(*relative), *relative);
      greatest = std::max(greatest.value_or(*relative), *relative);
    }
  }
};

std::string text_of(const std::optional<Json>& value) {
  return value ? value_of(*value).substr(0, 20) : "missing";
}

std::string move_line(const std::string& key, const Move& move, std::size_t runs) {
  char range[64] = "";
  if (move.least)
    std::snprintf(range, sizeof(range), "  %+.4g to %+.4g %%", 100 * *move.least, 100 * *move.greatest);
  return "  " + key + ": in " + std::to_string(move.runs) + " of " + std::to_string(runs) + " runs" + range +
         "; " + move.first_run + ": " + text_of(move.first.a) + " -> " + text_of(move.first.b) + '\n';
}

using Presence = GoldenVerdict::Presence;
constexpr std::array kPresenceNames = {"both", "only_found", "only_kept"};  ///< in the order of Presence

/// "" of a run that was made and is kept.
std::string presence_line(const GoldenVerdict& verdict) {
  if (verdict.presence == Presence::both) return "";
  return (verdict.presence == Presence::only_found ? "  new run: " : "  run gone: ") +
         shortened(printable(verdict.run)) + '\n';
}

/// Runs of all files by "cornell_box-paper full n1 both lt".
std::vector<std::pair<std::string, const FlatStatistics*>> runs_of(const GoldenTables& tables) {
  std::vector<std::pair<std::string, const FlatStatistics*>> runs;
  for (const auto& [file, table] : tables)
    for (const auto& [name, values] : table)
      runs.emplace_back(fs::path(file).stem().string() + ' ' + name, &values);
  return runs;
}

}  // namespace

GoldenScenes load_golden_scenes(const GoldenGrid& grid, bool is_outside_allowed) {
  GoldenScenes scenes;
  for (const GoldenRun& run : grid.runs)
    if (!run.plug_in && scenes.count(run.scene) == 0) {
      Scene scene = load_scene(run.scene, is_outside_allowed);
      scene.film = grid.film;
      scenes.emplace(run.scene, std::move(scene));
    }
  return scenes;
}

GoldenTables run_golden(const GoldenGrid& grid, const GoldenScenes& scenes, int jobs,
                        const std::function<void(double)>& progress) {
  std::vector<std::function<std::string()>> work;
  for (const GoldenRun& run : grid.runs) work.emplace_back([&] { return json_text(kept_of(run, scenes)); });
  const std::vector<std::string> results = run_in_processes(work, jobs, [&](int finished) {
    if (progress) progress(finished / double(work.size()));
  });
  GoldenTables tables;
  for (std::size_t i = 0; i < results.size(); ++i)
    tables[grid.runs[i].file].emplace_back(grid.runs[i].name, Json::parse(results[i]).get<FlatStatistics>());
  return tables;
}

GoldenTables read_golden(const fs::path& directory) {
  GoldenTables tables;
  for (const fs::directory_entry& entry : fs::directory_iterator(directory))
    if (entry.path().extension() == ".csv") tables[entry.path().filename()] = read_table(entry.path());
  return tables;
}

void write_golden(const fs::path& directory, const GoldenTables& tables) {
  std::vector<std::pair<fs::path, std::string>> files;
  for (const auto& [file, table] : tables) files.emplace_back(directory / file, table_csv(table));
  write_together(files);
  for (const auto& [file, table] : read_golden(directory))
    if (tables.count(file) == 0) fs::remove(directory / file);
}

std::vector<GoldenVerdict> golden_verdicts(const GoldenTables& kept, const GoldenTables& found) {
  std::map<std::string, const FlatStatistics*> before;
  for (const auto& [run, values] : runs_of(kept)) before[run] = values;
  std::vector<GoldenVerdict> verdicts;
  for (const auto& [run, values] : runs_of(found)) {
    const auto old = before.find(run);
    if (old == before.end()) {
      verdicts.push_back({run, Presence::only_found});
    } else {
      verdicts.push_back({run, Presence::both, compare(*old->second, *values, {}).differences});
      before.erase(old);
    }
  }
  for (const auto& [run, values] : before) verdicts.push_back({run, Presence::only_kept});
  return verdicts;
}

std::string golden_moves(const std::vector<GoldenVerdict>& verdicts) {
  std::string text;
  std::vector<std::string> order;
  std::map<std::string, Move> moves;
  std::size_t runs = 0;
  for (const GoldenVerdict& verdict : verdicts) {
    runs += verdict.presence != Presence::only_kept;
    text += presence_line(verdict);
    for (const Difference& difference : verdict.moves) {
      if (moves.count(difference.key) == 0) order.push_back(difference.key);
      moves[difference.key].add(difference, verdict.run);
    }
  }
  for (const std::string& key : order) text += move_line(key, moves[key], runs);
  return text;
}

std::vector<TestCase> golden_cases(const std::vector<GoldenVerdict>& verdicts) {
  std::vector<TestCase> cases;
  for (const GoldenVerdict& verdict : verdicts) {
    std::string failure = presence_line(verdict);
    if (!verdict.moves.empty())
      failure += std::to_string(verdict.moves.size()) + " counters moved\n" + difference_text(verdict.moves);
    const std::size_t blank = verdict.run.find(' ');
    cases.push_back({verdict.run.substr(0, blank),
                     verdict.run.substr(std::min(blank, verdict.run.size() - 1) + 1), std::move(failure)});
  }
  return cases;
}

Json golden_json(const std::vector<GoldenVerdict>& verdicts) {
  Json list = Json::array();
  for (const GoldenVerdict& verdict : verdicts)
    list.push_back({{"run", verdict.run},
                    {"presence", kPresenceNames.at(std::size_t(verdict.presence))},
                    {"moves", differences_json(verdict.moves)}});
  return list;
}

}  // namespace testbench
