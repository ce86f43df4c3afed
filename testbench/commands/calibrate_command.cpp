#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "model/config/chip_presets.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/paper/paper_alternatives.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

using Json = nlohmann::ordered_json;

struct CalibrateCommand {
  SceneArgument scene{"scenes/cornell_box"};
  std::string closed_scene = "scenes/cornell_box_closed";
  SizeOption size;
  ChipOptions chip;
  LevelOption level;
  CalibrationOptions options;
  bool alternatives = false;
  OutputFiles outputs;

  void run() const;

 private:
  void write_header(const Calibration& result) const;
};

void print_header() {
  std::printf("%-34s %9s %8s %8s   %9s %9s\n%-34s %9s %8s %8s   %9s %9s\n", "assumption", "code", "cycles",
              "cycles", "mean", "worst", "", "quality", "a PE", "a call", "error", "error");
}

void print_row(const Assumptions& assumptions, const Calibration& result) {
  std::printf("%-34s %9.4f %8g %8g   %8.2f%% %8.2f%%%s\n", assumptions.name.c_str(),
              result.constants.code_quality_factor, result.constants.per_pe_cycles,
              result.constants.transfer_call_cycles, 100 * result.mean_error, 100 * result.worst_error,
              result.converged ? "" : "  (the fitted cells cannot be met)");
}

Json to_json(const Assumptions& assumptions, const Calibration& result) {
  Json json{{"assumption", assumptions.name}, {"chips", assumptions.chip.board.chips}};
  for (const auto& [key, value] : result.constants.settings()) json["constants"][key] = value;
  json["converged"] = result.converged;
  json["iterations"] = result.iterations;
  json["mean_error_of_predicted"] = result.mean_error;
  json["worst_error_of_predicted"] = result.worst_error;
  const std::vector<PaperCell> cells = paper_cells();
  for (std::size_t i = 0; i < cells.size(); ++i)
    json["cells"].push_back({{"cell", cells[i].name()},
                             {"model_seconds", result.seconds[i]},
                             {"paper_seconds", cells[i].seconds()},
                             {"fitted", is_fitted(cells[i])}});
  return json;
}

void CalibrateCommand::write_header(const Calibration& result) const {
  if (!result.converged)
    throw RunError("--write: found no constants that meet the fitted cells; " + outputs.path("--write") +
                   " is not written");
  outputs.write("--write", [&] { return paper_constants_header(result.constants); });
}

void CalibrateCommand::run() const {
  outputs.require_writable();
  CalibrationOptions fit = options;
  fit.level = level.level();
  size.require_valid();
  const Assumptions base{"preset paper", chip.chip(), paper_program(), size.resized(scene.load())};
  std::optional<Scene> closed;
  if (alternatives) closed = size.resized(scene.load_other(closed_scene));
  const std::vector<Assumptions> all =
      closed ? paper_alternatives(base, *closed) : std::vector<Assumptions>{base};
  for (const Assumptions& assumptions : all) outputs.require_no_input(inputs_of(chip, assumptions.scene));
  std::printf("Three constants fitted to three cells (");
  for (const PaperCell& cell : fitted_cells())
    std::printf("%s%s", cell.row == 1 && cell.program == path_tracer::Program::segments ? "" : "; ",
                cell.name().c_str());
  std::printf("), errors of the other cells\n\n");
  print_header();
  Json rows = Json::array();
  for (const Assumptions& assumptions : all) {
    const Calibration result = calibrate(
        assumptions, fit, [](const std::string& line) { std::fprintf(stderr, "  %s\n", line.c_str()); });
    print_row(assumptions, result);
    std::fflush(stdout);
    rows.push_back(to_json(assumptions, result));
    if (&assumptions == &all.front() && !outputs.path("--write").empty()) write_header(result);
  }
  print_notes(base.scene.notes);
  if (closed) print_notes(closed->notes);
  outputs.write("--json", [&] { return json_text(rows, 2) + "\n"; });
}

}  // namespace

void add_calibrate_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "calibrate",
      "Fit the constants of preset paper to three cells of the paper's tables, predict the others");
  const auto state = std::make_shared<CalibrateCommand>();
  state->scene.add_to(command);
  command.add_option("--closed-scene", state->closed_scene, "Scene of the alternative 'closed box'")
      ->capture_default_str();
  state->size.add_to(command);
  state->chip.add_to(command, "paper");
  state->level.add_to(command);
  add_samples_option(command, state->options.samples);
  add_jobs_option(command, state->options.at_once);
  command.add_flag("--alternatives", state->alternatives,
                   "Fit again under each alternative to what the paper leaves open");
  state->outputs.add_to(command, "--write",
                        "Write the constants as a C++ header (model/config/paper_constants.hpp)");
  state->outputs.add_to(command, "--json", "Also write constants and cells to this file");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
