#include <algorithm>
#include <map>
#include <set>

#include "testbench/files/input_file.hpp"
#include "testbench/golden/golden.hpp"
#include "testbench/plug_in/firmware_path.hpp"
#include "testbench/run/run_settings.hpp"
#include "testbench/run/timing_name.hpp"
#include "testbench/run/toml_settings.hpp"
#include "testbench/statistics/renamed_keys.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/nesting.hpp"

namespace testbench {
namespace {

namespace fs = std::filesystem;
using Settings = std::vector<Setting>;

constexpr const char* kFirmware = "firmware.";

/// Combinations that the grids of a file may ask for, with those that they have in common.
constexpr std::size_t kMostRuns = 10'000;

/// Keys of earlier grids, and the settings that they are called now.
const std::map<std::string, std::string>& old_keys() {
  static const std::map<std::string, std::string> keys = {{"scenes", "scene"},
                                                          {"chips", "chip"},
                                                          {"timings", "timing"},
                                                          {"programs", "firmware.program"},
                                                          {"n", "firmware.n"},
                                                          {"buffers", "firmware.buffer"},
                                                          {"traversals", "firmware.traversal"},
                                                          {"node_formats", "firmware.node_format"},
                                                          {"node_widths", "firmware.node_width"}};
  return keys;
}

class GridReader {
 public:
  explicit GridReader(const fs::path& directory) : directory_(directory), file_(directory / "grid.toml") {}

  GoldenGrid read() {
    const std::string text = read_input_file(file_, "a grid of golden runs", kMostTomlBytes);
    require_shallow_toml(text, file_);
    toml::table table;
    try {
      table = toml::parse(text, file_);
    } catch (const toml::parse_error& error) {
      throw InputError(file_ + ":" + std::to_string(error.source().begin.line) +
                       ": cannot be read as TOML: " + std::string(error.description()));
    }
    for (const auto& [key, node] : table)
      if (static const std::set<std::string_view> known = {"width", "height", "samples", "grid"};
          known.count(key.str()) == 0)
        refuse(line_of(file_, node), std::string(key.str()), "an unknown key",
               "width, height, samples and [[grid]]");
    GoldenGrid grid;
    const toml::array* const grids = table["grid"].as_array();
    if (grids == nullptr || !grids->is_array_of_tables())
      refuse(file_, "grid", "none", "one [[grid]] or more");
    if (!std::all_of(grids->begin(), grids->end(), names_firmware)) {
      grid.film = {positive(table, "width"), positive(table, "height")};
      samples_ = positive(table, "samples");
    }
    for (const toml::node& node : *grids)
      for (const Settings& settings : product(*node.as_table()))
        add(make_run(settings, line_of(file_, node)), grid);
    return grid;
  }

 private:
  [[noreturn]] static void refuse(const std::string& origin, const std::string& key, const std::string& found,
                                  const std::string& allowed) {
    throw InputError(origin + ": " + key + ": found " + found + ", allowed is " + allowed);
  }

  /// Whether the runs of a [[grid]] are of firmware outside this tree; `firmware.n = [1]` is a table.
  static bool names_firmware(const toml::node& grid) { return (*grid.as_table())[kFirmwareKey].is_array(); }

  int positive(const toml::table& table, const char* key) const {
    constexpr std::int64_t kMost = 10000;
    const std::string allowed = "an integer from 1 to " + std::to_string(kMost);
    const toml::node* const node = table.get(key);
    if (node == nullptr) refuse(file_, key, "none", allowed);
    const auto value = node->value_exact<std::int64_t>();
    if (!value || *value < 1 || *value > kMost)
      refuse(line_of(file_, *node), key, found_text(*node), allowed);
    return int(*value);
  }

  /// One setting for each value of a key's list.
  Settings settings_of(const TomlLeaf& leaf) const {
    const std::string origin = line_of(file_, *leaf.node);
    if (const auto old = old_keys().find(leaf.key); old != old_keys().end())
      refuse(origin, leaf.key, "a name that is no longer used", old->second);
    if (!is_setting(leaf.key) && !is_plug_in_key(leaf.key)) require_current_key(origin, leaf.key);
    if (leaf.key == "size" || leaf.key == "samples")
      refuse(origin, leaf.key, "it in a [[grid]]", "width, height and samples of the whole file, above");
    const toml::array* const array = leaf.node->as_array();
    if (array == nullptr || array->empty())
      refuse(origin, leaf.key, array == nullptr ? found_text(*leaf.node) : "an empty list",
             "a list of values");
    Settings settings;
    for (const toml::node& node : *array) {
      const std::optional<std::string> value = scalar_text(node);
      if (!value) refuse(origin, leaf.key, found_text(node) + " in a list", "values");
      const bool names_file = leaf.key == "scene" || (leaf.key == kFirmwareKey && is_firmware_file(*value)) ||
                              (leaf.key == "chip" && fs::path(*value).extension() == ".toml");
      settings.push_back({leaf.key, names_file ? path_of(*value) : *value, origin});
      if (!is_plug_in_key(leaf.key)) require_allowed(settings.back());
    }
    return settings;
  }

  std::string path_of(const std::string& file) const {
    return (directory_ / file).lexically_normal().string();
  }

  /// All combinations; the last key of the file changes fastest.
  std::vector<Settings> product(const toml::table& table) {
    std::vector<Settings> runs(1);
    for (const TomlLeaf& leaf : leaves_of(table)) {
      const Settings values = settings_of(leaf);
      const std::size_t combinations = combinations_ + runs.size() * values.size();
      if (combinations > kMostRuns)
        refuse(line_of(file_, *leaf.node), leaf.key,
               std::to_string(combinations) + " combinations with the lists above",
               "at most " + std::to_string(kMostRuns));
      std::vector<Settings> longer;
      for (const Settings& run : runs)
        for (const Setting& setting : values) {
          longer.push_back(run);
          longer.back().push_back(setting);
        }
      runs = std::move(longer);
    }
    for (const Settings& run : runs)
      if (find(run, "scene") == nullptr && find(run, kFirmwareKey) == nullptr)
        refuse(line_of(file_, table), "scene", "none", "a list of scenes");
    combinations_ += runs.size();
    return runs;
  }

  /// Adds a run once: products may overlap. A table goes by the names of scene and chip, without their
  /// folders.
  void add(GoldenRun&& run, GoldenGrid& grid) const {
    for (const GoldenRun& known : grid.runs) {
      if (known.file != run.file || known.name != run.name) continue;
      if (source_of(known) == source_of(run) && known.chip == run.chip) return;
      const bool is_source = source_of(known) != source_of(run);
      refuse(file_,
             !is_source    ? "chip"
             : run.plug_in ? kFirmwareKey
                           : "scene",
             is_source ? source_of(known) + " and " + source_of(run) : known.chip + " and " + run.chip,
             "files of different names");
    }
    grid.runs.push_back(std::move(run));
  }

  static const std::string& source_of(const GoldenRun& run) {
    return run.plug_in ? run.plug_in->library->path() : run.scene;
  }

  /// nullptr for a key that the run does not set.
  static const Setting* find(const Settings& run, const std::string& key) {
    const auto found =
        std::find_if(run.begin(), run.end(), [&](const Setting& setting) { return setting.key == key; });
    return found == run.end() ? nullptr : &*found;
  }

  /// What `make` returns; its errors name the [[grid]].
  template <class Make>
  static auto with_origin(const std::string& origin, Make&& make) {
    try {
      return make();
    } catch (const InputError& error) {
      throw InputError(origin + ": " + error.what());
    }
  }

  std::shared_ptr<const SharedLibrary> library(const Setting& firmware) {
    std::shared_ptr<const SharedLibrary>& loaded = libraries_[firmware.value];
    if (!loaded)
      loaded =
          with_origin(firmware.origin, [&] { return std::make_shared<const SharedLibrary>(firmware.value); });
    return loaded;
  }

  /// "dgemm-csx600.csv", "lt option.panels=2"
  GoldenRun make_plug_in_run(const Settings& settings, const Setting& firmware, const std::string& origin) {
    const std::shared_ptr<const SharedLibrary> loaded = library(firmware);
    for (const Setting& setting : settings)
      if (is_plug_in_key(setting.key) && setting.key != kFirmwareKey) require_option(*loaded, setting);
    GoldenRun run;
    run.plug_in = with_origin(origin, [&] { return make_plug_in_settings(loaded, settings); });
    run.chip = run.plug_in->chip;
    run.file = firmware_name(loaded->path()) + "-" + fs::path(run.chip).stem().string() + ".csv";
    run.name = timing_name(run.plug_in->options.timing);
    for (const Setting& setting : settings)
      if (setting.key != kFirmwareKey && setting.key != "chip" && setting.key != "timing")
        run.name += " " + setting.key + "=" + setting.value;
    return run;
  }

  GoldenRun make_run(const Settings& settings, const std::string& origin) {
    if (const Setting* const firmware = find(settings, kFirmwareKey))
      return make_plug_in_run(settings, *firmware, origin);
    const RunSettings made = with_origin(origin, [&] { return make_settings(settings); });
    GoldenRun run;
    run.scene = made.scene;
    run.chip = made.chip;
    run.options = made.options;
    run.options.work.samples = samples_;
    // A golden run says how rays find triangles: what suits them best may change, its counters must not.
    run.given = {"traversal", "node_format", "node_width"};
    for (const Setting& setting : settings)
      if (setting.key.rfind(kFirmware, 0) == 0) run.given.insert(setting.key.substr(9));
    run.file = fs::path(made.scene).filename().string() + "-" + fs::path(made.chip).stem().string() + ".csv";
    run.name = name_of_run(made, settings);
    return run;
  }

  /// "full n1 both lt", with a tree "full n1 both lt refill fp32 4"; then what else the grid sets.
  static std::string name_of_run(const RunSettings& run, const Settings& settings) {
    std::set<std::string> said = {"scene", "chip"};
    const auto say = [&](const std::string& key) {
      said.insert(key);
      return value_of(run, key);
    };
    std::string name = say("firmware.program") + " n" + say("firmware.n") + " " + say("firmware.buffer") +
                       " " + say("timing");
    const std::string tree = " " + say("firmware.traversal") + " " + say("firmware.node_format") + " " +
                             say("firmware.node_width");
    if (run.options.program.uses_tree()) name += tree;
    for (const Setting& setting : settings)
      if (said.count(setting.key) == 0) name += " " + setting.key + "=" + setting.value;
    return name;
  }

  fs::path directory_;
  std::string file_;
  int samples_ = 0;
  std::map<std::string, std::shared_ptr<const SharedLibrary>> libraries_;  ///< by the grid's name for them
  std::size_t combinations_ = 0;                                           ///< of the grids so far
};

}  // namespace

GoldenGrid read_golden_grid(const fs::path& directory) {
  return GridReader(directory).read();
}

}  // namespace testbench
