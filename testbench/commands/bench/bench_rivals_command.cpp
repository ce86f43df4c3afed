#include <cstdio>
#include <memory>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/benchmark/rivals.hpp"
#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/scene_file/generated_scene.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

struct BenchRivalsCommand {
  RivalsQuestion question;
  SizeOption size;
  ChipOptions chip;
  TimingOption timing;
  LevelOption level;
  int jobs = 1;
  OutputFiles outputs;

  void run();
};

void BenchRivalsCommand::run() {
  outputs.require_writable();
  size.require_valid();
  Scene sized;
  sized.film = question.film;
  question.film = size.resized(std::move(sized)).film;
  question.options.chip = chip.chip();
  question.options.level = level.level();
  question.options.timing = timing.style();
  ProgressBar bar("bench rivals");
  const std::vector<RivalCosts> costs =
      measure_rivals(question, jobs, [&](double share) { bar.show(share); });
  std::printf("a blob in a box at %d x %d, %d paths a pixel, program segments; chip %s\n\n%s",
              question.film.width, question.film.height, question.options.work.samples,
              question.options.chip.preset.c_str(), rivals_text(costs).c_str());
  outputs.write("--csv", [&] { return rivals_csv(costs); });
  const std::string& plot = outputs.path("--plot");
  if (plot.empty()) return;
  if (can_draw_charts())
    write_chart(plot, rivals_chart(costs));
  else
    print_note("--plot " + plot + " was left out: gnuplot is not installed");
}

}  // namespace

void add_bench_rivals_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "rivals", "Compare bins with packets and ray streams: cycles a ray by coherence, width and triangles");
  const auto state = std::make_shared<BenchRivalsCommand>();
  state->question.options.program = path_tracer::default_program();
  state->question.options.work.samples = 1;
  command.add_option("--triangles", state->question.triangles, "Numbers of triangles of the scene")
      ->delimiter(',')
      ->check(CLI::Range(kLeastGeneratedTriangles, kMostGeneratedTriangles))
      ->capture_default_str();
  command.add_option("--widths", state->question.widths, "Numbers of PEs")
      ->delimiter(',')
      ->capture_default_str();
  state->size.add_to(command);
  state->chip.add_to(command, "csx600");
  state->timing.add_to(command);
  state->level.add_to(command);
  add_samples_option(command, state->question.options.work.samples);
  add_jobs_option(command, state->jobs);
  state->outputs.add_to(command, "--csv", "Also write the costs to this file");
  state->outputs.add_to(command, "--plot", "Also draw the costs to this file (.png or .svg; needs gnuplot)");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
