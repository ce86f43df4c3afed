#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "testbench/atomic_file.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/paper.hpp"
#include "testbench/processes.hpp"
#include "testbench/progress_bar.hpp"
#include "testbench/render.hpp"
#include "testbench/scene/scene_file.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using path_tracer::Program;

constexpr Program kPrograms[] = {Program::segments, Program::direct, Program::full};

struct Cell {
  double model_seconds = 0;  ///< for 1,000,000 path segments
  double paper_seconds = 0;

  double error_percent() const { return 100 * (model_seconds / paper_seconds - 1); }
};

struct ReproduceCommand {
  std::string scene = "scenes/cornell_box";
  ChipOptions chip;
  LevelOption level;
  int samples = 4;
  bool check_hazards = false;
  int jobs = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  std::string json;

  void run() const;

 private:
  std::vector<Cell> measure(const Scene& loaded, const RenderOptions& options) const;
};

/// Seconds of simulated time for 1,000,000 segments.
double measure_cell(const Scene& scene, const RenderOptions& options) {
  const RenderResult result = render_on_chip(scene, options);
  return result.chip->seconds() * 1e6 / double(result.counts.segments);
}

std::vector<Cell> ReproduceCommand::measure(const Scene& loaded, const RenderOptions& options) const {
  std::vector<std::function<std::string()>> runs;
  for (const PaperRow& row : paper_rows()) {
    for (const Program program : kPrograms) {
      RenderOptions of_cell = options;
      of_cell.program.program = program;
      of_cell.program.n = row.n;
      of_cell.program.buffer_loads = row.buffer_loads;
      of_cell.program.buffer_saves = row.buffer_saves;
      runs.emplace_back([&loaded, of_cell] { return Json(measure_cell(loaded, of_cell)).dump(); });
    }
  }
  ProgressBar bar("reproduce");
  const std::vector<std::string> results =
      run_in_processes(runs, jobs, [&](int finished) { bar.show(finished / double(runs.size())); });
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < results.size(); ++i)
    cells.push_back({Json::parse(results[i]).get<double>(), paper_rows()[i / 3].seconds[i % 3]});
  return cells;
}

/// Rows n = 1 of Table 1 and "both" of Table 2 are one run.
bool is_fitted(std::size_t row, std::size_t column) {
  const PaperRow& of = paper_rows()[row];
  return of.n == kFittedN && of.buffer_loads && of.buffer_saves && kPrograms[column] == kFittedProgram;
}

void print_table(int table, const char* title, const std::vector<Cell>& cells) {
  std::printf("Table %d: %s, seconds for 1,000,000 path segments\n", table, title);
  std::printf("  %-8s", "");
  for (const Program program : kPrograms) std::printf("  %-26s", program_name(program));
  std::printf("\n  %-8s", "");
  for (std::size_t i = 0; i < std::size(kPrograms); ++i)
    std::printf("  %7s %7s %9s ", "model", "paper", "error");
  std::printf("\n");
  for (std::size_t row = 0; row < paper_rows().size(); ++row) {
    if (paper_rows()[row].table != table) continue;
    std::printf("  %-8s", paper_rows()[row].label);
    for (std::size_t column = 0; column < 3; ++column) {
      const Cell& cell = cells[3 * row + column];
      std::printf("  %7.2f %7.2f %+8.1f%%%c", cell.model_seconds, cell.paper_seconds, cell.error_percent(),
                  is_fitted(row, column) ? '*' : ' ');
    }
    std::printf("\n");
  }
}

void print_summary(const std::vector<Cell>& cells) {
  constexpr std::size_t kRowOfOneBuffer = 1;
  const double direct = cells[3 * kRowOfOneBuffer + 1].model_seconds;
  const double full = cells[3 * kRowOfOneBuffer + 2].model_seconds;
  double worst = 0;
  double sum = 0;
  for (const Cell& cell : cells) {
    worst = std::max(worst, std::abs(cell.error_percent()));
    sum += std::abs(cell.error_percent());
  }
  std::printf("Radiance at n = 1: %.2f %% of the full computation (paper: %.2f %%)\n",
              100 * (1 - direct / full), 100 * (1 - 13.17 / 13.28));
  std::printf(
      "Error: %.1f %% mean, %.1f %% worst of %zu cells (* the cell that preset paper was fitted to)\n",
      sum / double(cells.size()), worst, cells.size());
}

Json to_json(const std::vector<Cell>& cells, const RenderOptions& options) {
  Json json;
  json["format"] = "csx600-reproduce-1";
  json["chip_preset"] = options.chip.preset;
  json["samples"] = options.work.samples;
  json["cells"] = Json::array();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const PaperRow& row = paper_rows()[i / 3];
    json["cells"].push_back({{"table", row.table},
                             {"row", row.label},
                             {"program", program_name(kPrograms[i % 3])},
                             {"model_seconds", cells[i].model_seconds},
                             {"paper_seconds", cells[i].paper_seconds},
                             {"error_percent", cells[i].error_percent()},
                             {"fitted", is_fitted(i / 3, i % 3)}});
  }
  return json;
}

void ReproduceCommand::run() const {
  if (!json.empty()) require_writable(json);
  RenderOptions options;
  options.chip = chip.chip();
  options.level = level.level();
  options.work.samples = samples;
  options.check_hazards = check_hazards;
  const Scene loaded = load_scene(scene);
  const std::vector<Cell> cells = measure(loaded, options);
  std::printf("%s at %d x %d, %d samples a pixel; chip %s\n\n", loaded.name.c_str(), loaded.film.width,
              loaded.film.height, samples, options.chip.preset.c_str());
  print_table(1, "level of buffering n", cells);
  std::printf("\n");
  print_table(2, "what is buffered, n = 1", cells);
  std::printf("\n");
  print_summary(cells);
  if (!json.empty()) write_bytes_atomically(json, to_json(cells, options).dump(2) + "\n");
}

}  // namespace

void add_reproduce_command(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("reproduce", "Run the paper's Tables 1 and 2 and print both side by side");
  const auto state = std::make_shared<ReproduceCommand>();
  command.add_option("scene", state->scene, "Scene to run")->capture_default_str();
  state->chip.add_to(command, "paper");
  state->level.add_to(command);
  command.add_option("--samples", state->samples, "Paths a pixel")
      ->check(CLI::Range(1, 1 << 20))
      ->capture_default_str();
  command.add_option("--jobs", state->jobs, "Runs at a time")
      ->check(CLI::Range(1, 1024))
      ->capture_default_str();
  command.add_flag(
      "--check-hazards", state->check_hazards,
      "Stop when the firmware uses what a transfer may still read or write (kernels at level v2)");
  command.add_option("--json", state->json, "Also write the cells to this file");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
