#include <cstdio>
#include <memory>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/golden/golden.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/progress_bar.hpp"

namespace testbench {
namespace {

struct GoldenCommand {
  std::string directory;
  ReachOption reach;
  bool update = false;
  int jobs = 1;
  OutputFiles outputs;

  void run() const {
    outputs.require_writable();
    const GoldenGrid grid = read_golden_grid(directory);
    const GoldenTables kept = read_golden(directory);
    const GoldenScenes scenes = load_golden_scenes(grid, reach.is_outside_allowed());
    GoldenTables found;
    {
      ProgressBar bar("golden runs");
      found = run_golden(grid, scenes, jobs, [&](double share) { bar.show(share); });
    }
    for (const auto& [path, scene] : scenes) print_notes(scene.notes);
    const std::vector<GoldenVerdict> verdicts = golden_verdicts(kept, found);
    const std::string moves = golden_moves(verdicts);
    std::fputs(moves.c_str(), stdout);
    outputs.write("--junit", [&] { return junit_xml("golden " + directory, golden_cases(verdicts)); });
    outputs.write("--json", [&] { return json_text(golden_json(verdicts), 1) + "\n"; });
    std::printf("%zu runs, %s\n", grid.runs.size(), moves.empty() ? "no counter moved" : "moved as listed");
    if (update) {
      write_golden(directory, found);
    } else if (!moves.empty()) {
      throw RunError(
          directory +
          ": runs differ from what is kept; if that is meant, csx600 golden --update writes them anew");
    }
  }
};

}  // namespace

void add_golden_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "golden", "Repeat the runs of DIRECTORY/grid.toml and compare them with the tables kept there");
  const auto state = std::make_shared<GoldenCommand>();
  command.add_option("directory", state->directory, "Where grid.toml and the tables are")
      ->type_name("DIRECTORY")
      ->required();
  command.add_flag("--update", state->update, "Show what moved and write the tables anew");
  state->outputs.add_to(command, "--junit", "Every run as a case of a JUnit test suite");
  state->outputs.add_to(command, "--json", "Every run with the counters that moved");
  state->reach.add_to(command);
  add_jobs_option(command, state->jobs);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
