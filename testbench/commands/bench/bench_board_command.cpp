#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "model/config/chip_parameters.hpp"
#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/run/energy.hpp"
#include "testbench/run/render.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/system/progress_bar.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

struct BenchBoardCommand {
  SceneArgument scene{"scenes/cornell_box"};
  FilmSize film{96, 96};
  ChipOptions chip;
  TimingOption timing;
  LevelOption level;
  int samples = 4;
  int jobs = 1;
  std::vector<int> chips{1, 2, 4};

  void run() const;
};

struct BoardPoint {
  const char* label;
  path_tracer::Program program;
};

constexpr BoardPoint kBoardPoints[] = {{"segments", path_tracer::Program::segments},
                                       {"direct", path_tracer::Program::direct},
                                       {"full", path_tracer::Program::full}};

/// Throws InputError for a number of chips that no board has.
std::vector<model::ChipConfig> boards_of(const model::ChipConfig& chip, const std::vector<int>& chips) {
  std::vector<model::ChipConfig> boards;
  for (const int count : chips) {
    boards.push_back(chip);
    try {
      model::set_parameter(boards.back(), "board.chips", std::to_string(count), "--chips");
    } catch (const model::ConfigError& error) {
      throw InputError(error.what());
    }
  }
  return boards;
}

std::string run_board(const Scene& scene, const RenderOptions& options) {
  const RenderResult render = render_on_chip(scene, options);
  const double millions = double(render.counts.segments) / 1e6;
  return Json{{"cycles", render.chip->firmware_cycles},
              {"millions_a_second", millions / render.chip->seconds()},
              {"millions_a_second_with_host", millions / render.chip->total_seconds()},
              {"joules_a_million", energy_of(*render.chip).joules() / millions},
              {"image", render.film.sha256()}}
      .dump();
}

void print_board(const char* label, int chips, const Json& point, const Json& first) {
  const auto times = [&](const char* rate) { return double(point[rate]) / double(first[rate]); };
  std::printf("  %-10s %5d %14llu %10.3f M %7.2f %12.2f %12.3f  %s\n", label, chips,
              static_cast<unsigned long long>(point["cycles"]), double(point["millions_a_second"]),
              times("millions_a_second"), times("millions_a_second_with_host"),
              double(point["joules_a_million"]), point["image"] == first["image"] ? "equal" : "differs");
}

void BenchBoardCommand::run() const {
  RenderOptions options;
  options.chip = chip.chip();
  options.level = level.level();
  options.timing = timing.style();
  options.work.samples = samples;
  const std::vector<model::ChipConfig> boards = boards_of(options.chip, chips);
  Scene loaded = scene.load();
  loaded.film = film;
  std::vector<std::function<std::string()>> runs;
  for (const BoardPoint& point : kBoardPoints)
    for (const model::ChipConfig& board : boards) {
      RenderOptions of_run = options;
      of_run.chip = board;
      of_run.program.program = point.program;
      runs.emplace_back([&loaded, of_run] { return run_board(loaded, of_run); });
    }
  ProgressBar bar("bench board");
  const std::vector<std::string> results =
      run_in_processes(runs, jobs, [&](int finished) { bar.show(finished / double(runs.size())); });
  std::printf(
      "%s at %d x %d, %d samples a pixel; chip %s with %d array%s; a DDR for each chip, one host link\n\n",
      loaded.name.c_str(), film.width, film.height, samples, options.chip.preset.c_str(),
      options.chip.chip.arrays, options.chip.chip.arrays == 1 ? "" : "s");
  std::printf("  %-10s %5s %14s %12s %7s %12s %12s\n  %-10s %5s %14s %12s %7s %12s %12s  %s\n", "", "", "",
              "", "", "times, with", "J a million", "program", "chips", "cycles", "segments/s", "times",
              "host link", "segments", "image");
  std::size_t next = 0;
  for (const BoardPoint& point : kBoardPoints) {
    const Json first = Json::parse(results[next]);
    for (const int count : chips) print_board(point.label, count, Json::parse(results[next++]), first);
  }
  print_notes(loaded.notes);
}

}  // namespace

void add_bench_board_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "board", "Compare boards of several chips that divide the samples of a render, on a film of 96 x 96");
  const auto state = std::make_shared<BenchBoardCommand>();
  state->scene.add_to(command);
  state->chip.add_to(command, "paper");
  state->timing.add_to(command);
  state->level.add_to(command);
  add_samples_option(command, state->samples);
  add_jobs_option(command, state->jobs);
  command
      .add_option("--chips", state->chips, "Numbers of chips; the first is what the others are compared with")
      ->delimiter(',')
      ->capture_default_str();
  command.callback([state] { state->run(); });
}

}  // namespace testbench
