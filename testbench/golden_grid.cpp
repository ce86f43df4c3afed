#include <toml++/toml.h>

#include <array>
#include <set>

#include "model/chip_file.hpp"
#include "testbench/error.hpp"
#include "testbench/golden.hpp"
#include "testbench/program_names.hpp"

namespace testbench {
namespace {

namespace fs = std::filesystem;

constexpr std::array kPrograms = {path_tracer::Program::segments, path_tracer::Program::direct,
                                  path_tracer::Program::full};

[[noreturn]] void refuse(const std::string& file, const std::string& key, const std::string& found,
                         const std::string& allowed) {
  throw InputError(file + ": " + key + ": found " + found + ", allowed is " + allowed);
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
  std::vector<std::string> list_of(const toml::table& table, const char* key,
                                   const std::set<std::string>& allowed) const {
    std::vector<std::string> values = list<std::string>(table, key);
    for (const std::string& value : values)
      if (allowed.count(value) == 0) {
        std::string names;
        for (const std::string& name : allowed) names += (names.empty() ? "" : ", ") + name;
        refuse(file_, key, value, "one of " + names);
      }
    return values;
  }

  /// Once: products may overlap.
  static void add(GoldenRun&& run, GoldenGrid& grid) {
    for (const GoldenRun& known : grid.runs)
      if (known.file == run.file && known.name == run.name) return;
    grid.runs.push_back(std::move(run));
  }

  void add_product(const toml::table& table, GoldenGrid& grid) const {
    only(table, {"scenes", "chips", "programs", "n", "buffers", "timings"});
    const auto programs = list_of(table, "programs", {"segments", "direct", "full"});
    const auto buffers = list_of(table, "buffers", {"both", "loads", "saves", "none"});
    const auto timings = list_of(table, "timings", {"lt", "at"});
    const auto depths = list<std::int64_t>(table, "n");
    for (const std::string& scene : list<std::string>(table, "scenes"))
      for (const std::string& chip : list<std::string>(table, "chips"))
        for (const std::string& program : programs)
          for (const std::int64_t n : depths)
            for (const std::string& buffer : buffers)
              for (const std::string& timing : timings)
                add(run(scene, chip, program, int(n), buffer, timing), grid);
  }

  GoldenRun run(const std::string& scene, const std::string& chip, const std::string& program, int n,
                const std::string& buffer, const std::string& timing) const {
    const fs::path path = (directory_ / scene).lexically_normal();
    GoldenRun run;
    run.scene = path;
    run.file = path.filename().string() + "-" + chip + ".csv";
    run.name = program + " n" + std::to_string(n) + " " + buffer + " " + timing;
    try {
      run.options.chip = model::load_chip(chip);
    } catch (const model::ConfigError& error) {
      throw InputError(file_ + ": " + error.what());
    }
    run.options.work.samples = samples_;
    run.options.program = program_;
    for (const path_tracer::Program one : kPrograms)
      if (program_name(one) == program) run.options.program.program = one;
    run.options.program.n = n;
    run.options.program.buffer_loads = buffer == "both" || buffer == "loads";
    run.options.program.buffer_saves = buffer == "both" || buffer == "saves";
    run.options.timing =
        timing == "at" ? model::TimingStyle::approximately_timed : model::TimingStyle::loosely_timed;
    return run;
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
