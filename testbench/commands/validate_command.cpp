#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/statistics/json_file.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/validation/validation.hpp"

namespace testbench {
namespace {

struct ValidateCommand {
  SetOptions settings;
  LevelOption level;
  int jobs = 1;
  OutputFiles outputs;

  void run() const {
    outputs.require_writable();
    ValidationOptions options;
    options.chip = [this](const std::string& preset) { return settings.chip(preset); };
    options.level = level.level();
    options.jobs = jobs;
    Validation validation;
    {
      ProgressBar bar("validate");
      validation = validate(options, [&](double share) { bar.show(share); });
    }
    std::fputs(validation_text(validation).c_str(), stdout);
    outputs.write("--json", [&] { return json_text(to_json(validation), 2) + "\n"; });
    outputs.write("--csv", [&] { return validation_csv(validation); });
  }
};

}  // namespace

void add_validate_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "validate",
      "Run DGEMM, Monte Carlo, FFT and PIO sweeps and print published figures beside the model's");
  const auto state = std::make_shared<ValidateCommand>();
  state->settings.add_to(command);
  state->level.add_to(command);
  add_jobs_option(command, state->jobs);
  state->outputs.add_to(command, "--json", "Also write figures, cycles and bandwidths to this file");
  state->outputs.add_to(command, "--csv", "Also write the figures to this file");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
