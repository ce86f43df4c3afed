#include <cstdio>
#include <memory>

#include "model/config/parameter_report.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/system/atomic_file.hpp"

namespace testbench {
namespace {

struct ParamsCommand {
  ChipOptions chip;
  bool presets = false;
  std::string json;

  void run() const {
    if (!json.empty()) require_writable(json);
    const model::ChipConfig config = chip.chip();
    const std::string report = presets ? model::preset_text_report() : model::parameter_text_report(config);
    std::fputs(report.c_str(), stdout);
    if (!json.empty()) write_bytes_atomically(json, model::parameter_json_report(config));
  }
};

}  // namespace

void add_params_command(CLI::App& app) {
  CLI::App& command =
      *app.add_subcommand("params", "Print every chip parameter: value, unit, confidence, meaning");
  const auto state = std::make_shared<ParamsCommand>();
  state->chip.add_to(command, "csx600");
  command.add_flag("--presets", state->presets, "Print the presets and what they change instead");
  command.add_option("--json", state->json, "Also write the parameters to this file");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
