#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/commands/reproduce_claims.hpp"
#include "testbench/commands/reproduce_fastest.hpp"
#include "testbench/paper/paper_runs.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;
using path_tracer::Program;

struct Cell {
  PaperCell of;
  double model_seconds = 0;  ///< for 1,000,000 path segments

  double error_percent() const { return 100 * (model_seconds / of.seconds() - 1); }
};

struct ReproduceCommand {
  SceneArgument scene{"scenes/cornell_box"};
  ChipOptions chip;
  TimingOption timing;
  LevelOption level;
  SizeOption size;
  int samples = 4;
  bool check_hazards = false;
  int jobs = 1;
  bool image = false;
  bool claims = false;
  bool fastest = false;
  OutputFiles outputs;

  void run() const;

 private:
  RenderOptions make_options() const;
  std::vector<Cell> measure(const Scene& loaded, const RenderOptions& options) const;
  void measure_image(const Scene& loaded, RenderOptions options) const;
  void judge(const Scene& loaded, const RenderOptions& options) const;
  void show_fastest(const Scene& loaded, const RenderOptions& options) const;
};

std::vector<Cell> ReproduceCommand::measure(const Scene& loaded, const RenderOptions& options) const {
  ProgressBar bar("reproduce");
  const std::vector<double> seconds =
      run_paper_cells(loaded, options, paper_cells(), jobs, [&](double share) { bar.show(share); });
  std::vector<Cell> cells;
  for (std::size_t i = 0; i < seconds.size(); ++i) cells.push_back({paper_cells()[i], seconds[i]});
  return cells;
}

void print_table(int table, const char* title, const std::vector<Cell>& cells) {
  std::printf("Table %d: %s, seconds for 1,000,000 path segments\n", table, title);
  std::printf("  %-8s", "");
  for (const Program program : kPaperPrograms) std::printf("  %-26s", name_of(program));
  std::printf("\n  %-8s", "");
  for (std::size_t i = 0; i < kPaperPrograms.size(); ++i)
    std::printf("  %7s %7s %9s ", "model", "paper", "error");
  std::printf("\n");
  for (std::size_t row = 0; row < paper_rows().size(); ++row) {
    if (paper_rows()[row].table != table) continue;
    std::printf("  %-8s", paper_rows()[row].label);
    for (std::size_t column = 0; column < 3; ++column) {
      const Cell& cell = cells[3 * row + column];
      std::printf("  %7.2f %7.2f %+8.1f%%%c", cell.model_seconds, cell.of.seconds(), cell.error_percent(),
                  is_fitted(cell.of) ? '*' : ' ');
    }
    std::printf("\n");
  }
}

void print_summary(const std::vector<Cell>& cells) {
  std::vector<double> model;
  std::vector<double> paper;
  for (const Cell& cell : cells) {
    model.push_back(cell.model_seconds);
    paper.push_back(cell.of.seconds());
  }
  std::printf("Radiance at n = 1: %.2f %% of the full computation (paper: %.2f %%)\n",
              100 * radiance_share(model), 100 * radiance_share(paper));
  const PredictionError error = prediction_error(model);
  std::printf(
      "Error of the %d predicted cells: %.1f %% mean, %.1f %% worst (* preset paper was fitted to this "
      "cell)\n",
      error.cells, 100 * error.mean, 100 * error.worst);
}

/// Samples that give about the paper's segments; the time is scaled to exactly as many.
void ReproduceCommand::measure_image(const Scene& loaded, RenderOptions options) const {
  options.work.samples = 1;
  const RenderResult one_sample = render_natively(loaded, options);
  options.work.samples =
      static_cast<int>(std::lround(kPaperImageSegments / double(one_sample.counts.segments)));
  ProgressBar bar("image");
  const RenderResult result = render_on_chip(loaded, options, [&](double share) {
    bar.show(share);
    return true;
  });
  const double seconds = result.chip->seconds() * kPaperImageSegments / double(result.counts.segments);
  std::printf(
      "Image of 480 x 480 with 1000 segments a pixel: %.2f s, paper %.2f s, error %+.1f %%\n"
      "  (%d samples a pixel, %.1f M segments, simulator %.1f s CPU: %.1f times faster than the silicon)\n",
      seconds, kPaperImageSeconds, 100 * (seconds / kPaperImageSeconds - 1), options.work.samples,
      double(result.counts.segments) / 1e6, result.cpu_seconds,
      double(result.counts.segments) / result.cpu_seconds / (kPaperImageSegments / kPaperImageSeconds));
}

void ReproduceCommand::judge(const Scene& loaded, const RenderOptions& options) const {
  const std::vector<JudgedClaim> judged = judge_claims(loaded, options, jobs);
  std::printf("%s at %d x %d, %d samples a pixel; chip %s\n\n%s", loaded.name.c_str(), loaded.film.width,
              loaded.film.height, samples, options.chip.preset.c_str(), claims_text(judged).c_str());
  outputs.write("--json", [&] { return json_text(claims_json(judged, options), 2) + "\n"; });
}

void ReproduceCommand::show_fastest(const Scene& loaded, const RenderOptions& options) const {
  ProgressBar bar("fastest");
  const std::vector<FastestFigures> figures =
      measure_fastest(loaded, options, jobs, [&](double share) { bar.show(share); });
  const ImageDistance distance = compare_first_and_last(loaded, options);
  std::printf("%s at %d x %d, %d samples a pixel; chip %s\n\n%s", loaded.name.c_str(), loaded.film.width,
              loaded.film.height, samples, options.chip.preset.c_str(),
              fastest_text(figures, distance).c_str());
  outputs.write("--json", [&] { return json_text(fastest_json(figures, distance, options), 2) + "\n"; });
  const std::string& plot = outputs.path("--plot");
  if (plot.empty()) return;
  if (can_draw_charts())
    write_chart(plot, fastest_chart(figures));
  else
    print_note("--plot " + plot + " was left out: gnuplot is not installed");
}

Json to_json(const std::vector<Cell>& cells, const RenderOptions& options) {
  Json json;
  json["format"] = "csx600-reproduce-1";
  json["chip_preset"] = options.chip.preset;
  json["samples"] = options.work.samples;
  json["cells"] = Json::array();
  for (const Cell& cell : cells) {
    const PaperRow& row = paper_rows()[cell.of.row];
    json["cells"].push_back({{"table", row.table},
                             {"row", row.label},
                             {"program", name_of(cell.of.program)},
                             {"model_seconds", cell.model_seconds},
                             {"paper_seconds", cell.of.seconds()},
                             {"error_percent", cell.error_percent()},
                             {"fitted", is_fitted(cell.of)}});
  }
  return json;
}

RenderOptions ReproduceCommand::make_options() const {
  RenderOptions options;
  options.chip = chip.chip();
  options.timing = timing.style();
  options.level = level.level();
  options.program = paper_program();
  options.work.samples = samples;
  options.check_hazards = check_hazards;
  return options;
}

void ReproduceCommand::run() const {
  outputs.require_writable();
  const RenderOptions options = make_options();
  size.require_valid();
  const Scene loaded = size.resized(scene.load());
  outputs.require_no_input(inputs_of(chip, loaded));
  if (image || claims || fastest) {
    if (image) measure_image(loaded, options);
    if (claims) judge(loaded, options);
    if (fastest) show_fastest(loaded, options);
    print_notes(loaded.notes);
    return;
  }
  const std::vector<Cell> cells = measure(loaded, options);
  std::printf("%s at %d x %d, %d samples a pixel; chip %s\n\n", loaded.name.c_str(), loaded.film.width,
              loaded.film.height, samples, options.chip.preset.c_str());
  print_table(1, "level of buffering n", cells);
  std::printf("\n");
  print_table(2, "what is buffered, n = 1", cells);
  std::printf("\n");
  print_summary(cells);
  print_notes(loaded.notes);
  outputs.write("--json", [&] { return json_text(to_json(cells, options), 2) + "\n"; });
}

}  // namespace

void add_reproduce_command(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("reproduce", "Run the paper's Tables 1 and 2 and print both side by side");
  const auto state = std::make_shared<ReproduceCommand>();
  state->scene.add_to(command);
  state->chip.add_to(command, "paper");
  state->timing.add_to(command);
  state->level.add_to(command);
  state->size.add_to(command);
  add_samples_option(command, state->samples);
  add_jobs_option(command, state->jobs);
  command.add_flag("--image", state->image, "Render the paper's image instead and compare its time");
  command
      .add_flag("--claims", state->claims,
                "Judge what the paper says, claim by claim, by fresh runs (--size 120x120 takes a minute)")
      ->excludes("--image");
  CLI::Option* const fastest =
      command
          .add_flag("--fastest", state->fastest,
                    "Go from the paper's program to the fastest of this firmware, and say what each change "
                    "brings")
          ->excludes("--image")
          ->excludes("--claims");
  add_check_hazards_flag(command, state->check_hazards);
  state->outputs.add_to(command, "--json", "Also write the cells, the claims or the steps to this file");
  state->outputs
      .add_to(command, "--plot",
              "Draw the steps of --fastest as SVG (name.svg) or PNG, if gnuplot is installed")
      .needs(fastest);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
