#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <set>

#include "model/config/chip_file.hpp"
#include "testbench/golden/golden.hpp"
#include "testbench/run/program_names.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

namespace fs = std::filesystem;

constexpr std::array kPrograms = {path_tracer::Program::segments, path_tracer::Program::direct,
                                  path_tracer::Program::full};

[[noreturn]] void refuse(const std::string& file, const std::string& key, const std::string& found,
                         const std::string& allowed) {
  throw InputError(file + ": " + key + ": found " + found + ", allowed is " + allowed);
}

/// One run, in the words of the grid.
struct RunKeys {
  std::string scene;
  std::string chip;
  std::string program;
  std::int64_t n = 0;
  std::string buffer;
  std::string timing;
  std::string traversal;
  std::string node_format;
  std::int64_t node_width = 0;
};

/// Each of the runs with each of the values.
template <class T>
void multiply(std::vector<RunKeys>& runs, T RunKeys::*key, const std::vector<T>& values) {
  std::vector<RunKeys> product;
  for (const RunKeys& run : runs)
    for (const T& value : values) {
      product.push_back(run);
      product.back().*key = value;
    }
  runs = std::move(product);
}

class GridReader {
 public:
  GridReader(const fs::path& directory, const path_tracer::ProgramConfig& program)
      : directory_(directory), file_(directory / "grid.toml"), program_(program) {}

  GoldenGrid read() {
    toml::table table;
    try {
      table = toml::parse_file(file_);
    } catch (const toml::parse_error& error) {
      throw InputError(file_ + ": cannot be read as TOML: " + std::string(error.description()));
    }
    only(table, {"width", "height", "samples", "grid"});
    GoldenGrid grid;
    grid.film = {positive(table, "width"), positive(table, "height")};
    samples_ = positive(table, "samples");
    const toml::array* const grids = table["grid"].as_array();
    if (grids == nullptr || !grids->is_array_of_tables())
      refuse(file_, "grid", "none", "one [[grid]] or more");
    for (const toml::node& node : *grids) add_product(*node.as_table(), grid);
    return grid;
  }

 private:
  void only(const toml::table& table, const std::set<std::string_view>& allowed) const {
    for (const auto& [key, node] : table)
      if (allowed.count(key.str()) == 0)
        refuse(file_, std::string(key.str()), "an unknown key", "one of those that the README lists");
  }

  int positive(const toml::table& table, const char* key) const {
    constexpr std::int64_t kMost = 10000;
    const auto value = table[key].value_exact<std::int64_t>();
    if (!value || *value < 1 || *value > kMost)
      refuse(file_, key, value ? std::to_string(*value) : "none",
             "an integer from 1 to " + std::to_string(kMost));
    return int(*value);
  }

  template <class T>
  std::vector<T> list(const toml::table& table, const char* key) const {
    std::vector<T> values;
    if (const toml::array* const array = table[key].as_array())
      for (const toml::node& node : *array)
        if (const auto value = node.value_exact<T>()) values.push_back(*value);
    const toml::array* const array = table[key].as_array();
    if (values.empty() || values.size() != array->size())
      refuse(file_, key, "no list or one with other values", "a list of strings, or of integers for n");
    return values;
  }
  template <class T>
  std::vector<T> list_of(const toml::table& table, const char* key, const std::vector<T>& allowed) const {
    std::vector<T> values = list<T>(table, key);
    for (const T& value : values)
      if (std::find(allowed.begin(), allowed.end(), value) == allowed.end())
        refuse(file_, key, word(value), "one of " + words(allowed));
    return values;
  }
  /// Of a key that may be left out.
  template <class T>
  std::vector<T> list_or(const T& otherwise, const toml::table& table, const char* key,
                         const std::vector<T>& allowed) const {
    return table.contains(key) ? list_of(table, key, allowed) : std::vector<T>{otherwise};
  }

  static std::string word(const std::string& value) { return value; }
  static std::string word(std::int64_t value) { return std::to_string(value); }
  template <class T>
  static std::string words(const std::vector<T>& values) {
    std::string joined;
    for (const T& value : values) joined += (joined.empty() ? "" : ", ") + word(value);
    return joined;
  }

  /// Once: products may overlap.
  static void add(GoldenRun&& run, GoldenGrid& grid) {
    for (const GoldenRun& known : grid.runs)
      if (known.file == run.file && known.name == run.name) return;
    grid.runs.push_back(std::move(run));
  }

  void add_product(const toml::table& table, GoldenGrid& grid) const {
    only(table, {"scenes", "chips", "programs", "n", "buffers", "timings", "traversals", "node_formats",
                 "node_widths"});
    using Words = std::vector<std::string>;
    const std::vector<std::int64_t> widths(std::begin(path_tracer::kNodeWidth),
                                           std::end(path_tracer::kNodeWidth));
    const path_tracer::NodeLayout& layout = program_.tree.layout;
    std::vector<RunKeys> runs(1);
    multiply(runs, &RunKeys::scene, list<std::string>(table, "scenes"));
    multiply(runs, &RunKeys::chip, list<std::string>(table, "chips"));
    multiply(runs, &RunKeys::program, list_of(table, "programs", Words{"direct", "full", "segments"}));
    multiply(runs, &RunKeys::n, list<std::int64_t>(table, "n"));
    multiply(runs, &RunKeys::buffer, list_of(table, "buffers", Words{"both", "loads", "none", "saves"}));
    multiply(runs, &RunKeys::timing, list_of(table, "timings", Words{"at", "lt"}));
    multiply(
        runs, &RunKeys::traversal,
        list_or(traversal_name(path_tracer::Traversal::brute_force), table, "traversals", traversal_names()));
    multiply(runs, &RunKeys::node_format,
             list_or(node_format_name(layout.format), table, "node_formats", node_format_names()));
    multiply(runs, &RunKeys::node_width, list_or(std::int64_t{layout.width}, table, "node_widths", widths));
    for (const RunKeys& keys : runs) add(run(keys), grid);
  }

  GoldenRun run(const RunKeys& keys) const {
    const fs::path path = (directory_ / keys.scene).lexically_normal();
    GoldenRun run;
    run.scene = path;
    run.file = path.filename().string() + "-" + keys.chip + ".csv";
    run.name = keys.program + " n" + std::to_string(keys.n) + " " + keys.buffer + " " + keys.timing;
    try {
      run.options.chip = model::load_chip(keys.chip);
    } catch (const model::ConfigError& error) {
      throw InputError(file_ + ": " + error.what());
    }
    run.options.work.samples = samples_;
    run.options.program = program_;
    for (const path_tracer::Program one : kPrograms)
      if (program_name(one) == keys.program) run.options.program.program = one;
    run.options.program.n = int(keys.n);
    run.options.program.buffer_loads = keys.buffer == "both" || keys.buffer == "loads";
    run.options.program.buffer_saves = keys.buffer == "both" || keys.buffer == "saves";
    run.options.timing =
        keys.timing == "at" ? model::TimingStyle::approximately_timed : model::TimingStyle::loosely_timed;
    run.options.program.traversal = traversals_by_name().at(keys.traversal);
    if (run.options.program.uses_tree()) set_tree(keys, run);
    return run;
  }

  static void set_tree(const RunKeys& keys, GoldenRun& run) {
    run.name += " " + keys.traversal + " " + keys.node_format + " " + std::to_string(keys.node_width);
    path_tracer::TreeShape& tree = run.options.program.tree;
    tree.resident_nodes = kAsManyAsFit;
    run.tree.node_format = node_formats_by_name().at(keys.node_format);
    run.tree.node_width = int(keys.node_width);
  }

  fs::path directory_;
  std::string file_;
  path_tracer::ProgramConfig program_;
  int samples_ = 0;
};

}  // namespace

GoldenGrid read_golden_grid(const fs::path& directory, const path_tracer::ProgramConfig& program) {
  return GridReader(directory, program).read();
}

}  // namespace testbench
