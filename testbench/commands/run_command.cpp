#include <cstdio>
#include <cstdlib>
#include <memory>
#include <nlohmann/json.hpp>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/exit_codes.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/commands/wave_options.hpp"
#include "testbench/observe/observation.hpp"
#include "testbench/plug_in/firmware_path.hpp"
#include "testbench/plug_in/plug_in_run.hpp"
#include "testbench/plug_in/shared_library.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/standard_output.hpp"
#include "testbench/system/time_limit.hpp"

namespace testbench {
namespace {

struct RunCommand {
  std::string library;
  std::vector<std::string> own_options;
  ChipOptions chip;
  TimingOption timing;
  LevelOption level;
  bool native = false;
  bool check_hazards = false;
  TimeLimitOption limit;
  OutputFiles outputs;
  ObservationOption observation;

  void run();

 private:
  PlugInOptions options() const;
  std::unique_ptr<plug_in::Firmware> make_firmware() const;
  PlugInResult run_limited(plug_in::Firmware& firmware, const PlugInOptions& options) const;
};

PlugInOptions RunCommand::options() const {
  PlugInOptions options{chip.chip(), timing.style(), native, check_hazards, {}};
  if (native && timing.style() == model::TimingStyle::approximately_timed)
    throw InputError("--timing: found at with --native, a native run has no clock; allowed is lt");
  if (native && observation.any())
    throw InputError(
        "--waves, --transactions, --timeline: a native run has no clock and records no waves; leave out "
        "--native");
  options.observation = observation.options(options.chip);
  outputs.require_writable(observation.outputs());
  require_writable(options.observation, options.chip);
  std::vector<InputName> inputs = chip.inputs();
  inputs.emplace_back("the firmware", firmware_path(library));
  outputs.require_no_input(inputs, observation.outputs());
  return options;
}

std::unique_ptr<plug_in::Firmware> RunCommand::make_firmware() const {
  const SharedLibrary plug_in(library);
  const cn::Level chosen = plug_in.choose_level(level.given());
  return check_hazards ? plug_in.make_observed() : plug_in.make(chosen);
}

PlugInResult RunCommand::run_limited(plug_in::Firmware& firmware, const PlugInOptions& options) const {
  const TimeLimit until(limit.seconds(), [](const std::string& message) {
    print_error(message);
    std::_Exit(kRunFailed.code);
  });
  return run_plug_in(firmware, options);
}

void RunCommand::run() {
  const std::unique_ptr<plug_in::Firmware> firmware = make_firmware();
  if (own_options == std::vector<std::string>{"--help"}) {
    std::fputs(describe_options(*firmware).c_str(), stdout);
    return;
  }
  set_options(*firmware, own_options);
  const PlugInOptions with = options();
  const PlugInResult result = run_limited(*firmware, with);
  outputs.write("--stats", [&] {
    return statistics_for_file(outputs.path("--stats"), plug_in_statistics(*firmware, with, result));
  });
  std::fputs(plug_in_table(*firmware, result).c_str(), stdout);
  if (!result.observation_failures.empty()) throw RunError(result.observation_failures);
}

std::string what_a_firmware_is() {
  std::string names;
  for (const std::string& name : installed_firmwares()) names += (names.empty() ? ": " : ", ") + name;
  return "Shared library that csx600_add_firmware() built, or the name of one that comes with csx600" + names;
}

}  // namespace

void add_run_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "run", "Run a firmware from a shared library, which may be built outside this tree");
  const auto state = std::make_shared<RunCommand>();
  command.add_option("firmware", state->library, what_a_firmware_is())->type_name("LIBRARY")->required();
  command
      .add_option("options", state->own_options,
                  "Behind --, the firmware's own options, --name value; -- --help lists them")
      ->type_name("OPTIONS");
  state->chip.add_to(command, "csx600");
  state->timing.add_to(command);
  state->level.add_to(command);
  command.add_flag("--native", state->native, "Run the firmware without SystemC: same results, no time");
  add_check_hazards_flag(command, state->check_hazards);
  state->limit.add_to(command);
  state->outputs.add_to(command, "--stats,--json",
                        "Write statistics: as CSV or text to a .csv or .txt file, otherwise as JSON");
  state->observation.add_to(command);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
