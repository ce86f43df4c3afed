#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/run/render.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/system/processes.hpp"
#include "testbench/system/progress_bar.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

struct BenchBoardCommand {
  SceneArgument scene{"scenes/cornell_box"};
  FilmSize film{96, 96};
  ChipOptions chip;
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

std::string run_board(const Scene& scene, RenderOptions options, path_tracer::Program program, int chips) {
  options.program.program = program;
  const BoardRender render = render_on_board(scene, options, chips);
  return Json{{"cycles", render.firmware_cycles},
              {"segments", render.segments},
              {"segments_per_second", double(render.segments) / render.seconds()},
              {"image", render.film.sha256()}}
      .dump();
}

void print_board(const char* label, int chips, const Json& point, const Json& first) {
  std::printf("  %-10s %5d %14llu %12llu %13.3f M %7.2f  %s\n", label, chips,
              static_cast<unsigned long long>(point["cycles"]),
              static_cast<unsigned long long>(point["segments"]), double(point["segments_per_second"]) / 1e6,
              double(point["segments_per_second"]) / double(first["segments_per_second"]),
              point["image"] == first["image"] ? "equal" : "differs");
}

void BenchBoardCommand::run() const {
  RenderOptions options;
  options.chip = chip.chip();
  options.level = level.level();
  options.work.samples = samples;
  Scene loaded = scene.load();
  loaded.film = film;
  std::vector<std::function<std::string()>> runs;
  for (const BoardPoint& point : kBoardPoints)
    for (const int count : chips)
      runs.emplace_back([&, count] { return run_board(loaded, options, point.program, count); });
  ProgressBar bar("bench board");
  const std::vector<std::string> results =
      run_in_processes(runs, jobs, [&](int finished) { bar.show(finished / double(runs.size())); });
  std::printf("%s at %d x %d, %d samples a pixel; chip %s; a DDR for each chip, one host link\n\n",
              loaded.name.c_str(), film.width, film.height, samples, options.chip.preset.c_str());
  std::printf("  %-10s %5s %14s %12s %15s %7s  %s\n", "program", "chips", "cycles", "segments", "segments/s",
              "times", "image");
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
  state->level.add_to(command);
  add_samples_option(command, state->samples);
  add_jobs_option(command, state->jobs);
  command
      .add_option("--chips", state->chips, "Numbers of chips; the first is what the others are compared with")
      ->delimiter(',')
      ->check(CLI::Range(1, 16))
      ->capture_default_str();
  command.callback([state] { state->run(); });
}

}  // namespace testbench
