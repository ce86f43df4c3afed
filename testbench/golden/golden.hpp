#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "testbench/plug_in/plug_in_settings.hpp"
#include "testbench/run/render.hpp"
#include "testbench/run/traversal_choice.hpp"
#include "testbench/statistics/test_report.hpp"

namespace testbench {

/// Whole-chip runs whose counters are kept in files, so that a change of any of them shows.
struct GoldenRun {
  std::string file;   ///< of the runs of one scene and chip: "cornell_box-csx600.csv"
  std::string name;   ///< its column: "full n1 both lt"
  std::string scene;  ///< path of its directory; "" of a firmware outside this tree
  std::string chip;   ///< preset, or path of its file
  RenderOptions options;
  GivenOptions given;  ///< options of the firmware that are not chosen as `csx600 render` does
  std::optional<PlugInSettings> plug_in;  ///< the firmware that runs instead of a render
};

/// The runs that DIRECTORY/grid.toml asks for:
///
///     width = 12               of the films, if there are any
///     height = 8
///     samples = 2              a pixel
///     [[grid]]                 all combinations of lists, by any key of a sweep (run_settings.hpp)
///     scene = ["../../scenes/cornell_box"]    relative to grid.toml
///     chip = ["csx600"]                       presets, or .toml files relative to grid.toml
///     firmware.program = ["segments", "direct", "full"]
///     firmware.n = [0, 1]
///     timing = ["lt"]
///     firmware.traversal = ["refill"]         brute_force if left out; node_format and node_width likewise
///     firmware.node_format = ["fp32"]         have their defaults
///
/// Other options of a tree are chosen as `csx600 render` does. In place of scenes, a [[grid]] may have
///
///     firmware = ["dgemm"]     names of installed firmwares, or libraries relative to grid.toml
///     option.panels = [2, 3]   their own options
///
/// Throws InputError.
struct GoldenGrid {
  FilmSize film;
  std::vector<GoldenRun> runs;
};
GoldenGrid read_golden_grid(const std::filesystem::path& directory);

/// What is kept of each run, by file and name: the counters (CounterKind::counted) without the simulator's,
/// and the image's hash or the counters of the firmware's own.
using GoldenTable = std::vector<std::pair<std::string, FlatStatistics>>;
using GoldenTables = std::map<std::string, GoldenTable>;

/// The scenes of all runs by path, with the grid's film. Throws InputError.
/// @param is_outside_allowed see load_scene()
using GoldenScenes = std::map<std::string, Scene>;
GoldenScenes load_golden_scenes(const GoldenGrid& grid, bool is_outside_allowed = false);

/// Runs them, each in a process of its own.
GoldenTables run_golden(const GoldenGrid& grid, const GoldenScenes& scenes, int jobs,
                        const std::function<void(double)>& progress = {});

/// The .csv files of the directory. Throws InputError for one that is not a table.
GoldenTables read_golden(const std::filesystem::path& directory);
/// Writes the tables, all or none, and removes .csv files of others. One row a counter, one column a run.
void write_golden(const std::filesystem::path& directory, const GoldenTables& tables);

/// A run that was made or is in the tables, and how its counters differ from those that are kept.
struct GoldenVerdict {
  enum class Presence : std::uint8_t { both, only_found, only_kept };

  std::string run;  ///< "cornell_box-paper full n1 both lt"
  Presence presence = Presence::both;
  std::vector<Difference> moves = {};  ///< a: kept, b: found

  bool has_moved() const { return presence != Presence::both || !moves.empty(); }
};

/// Every run, in the order of `found`; then those that are kept and were not made.
std::vector<GoldenVerdict> golden_verdicts(const GoldenTables& kept, const GoldenTables& found);

/// What moved: by counter, in how many runs and how far. "" when no counter did.
std::string golden_moves(const std::vector<GoldenVerdict>& verdicts);

/// A test case for each run, and for machines [{ run, presence, moves }].
std::vector<TestCase> golden_cases(const std::vector<GoldenVerdict>& verdicts);
nlohmann::ordered_json golden_json(const std::vector<GoldenVerdict>& verdicts);

}  // namespace testbench
