#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "model/config/parameter_report.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/run/option_report.hpp"
#include "testbench/statistics/json_file.hpp"

namespace testbench {
namespace {

struct ParamsCommand {
  ChipOptions chip;
  bool presets = false;
  bool markdown = false;
  OutputFiles outputs;

  void run() const {
    outputs.require_writable();
    outputs.require_no_input(chip.inputs());
    const model::ChipConfig config = chip.chip();
    std::fputs(text(config).c_str(), stdout);
    outputs.write("--json", [&] { return json(config); });
  }

 private:
  std::string text(const model::ChipConfig& config) const {
    if (presets) return model::preset_text_report();
    if (markdown)
      return "### Chip: preset " + config.preset + "\n\n" + model::parameter_markdown(config) + "\n" +
             option_markdown();
    return model::parameter_text_report(config) + "\nfirmware\n" + option_text_report();
  }

  /// The parameters of the chip, then the options of the firmware, in one array.
  static std::string json(const model::ChipConfig& config) {
    nlohmann::ordered_json report = nlohmann::ordered_json::parse(model::parameter_json_report(config));
    for (const nlohmann::ordered_json& option : option_json_report()) report.push_back(option);
    return json_text(report, 2) + "\n";
  }
};

}  // namespace

void add_params_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand(
      "params", "Print every parameter of the chip and every option of the firmware, with unit and meaning");
  const auto state = std::make_shared<ParamsCommand>();
  state->chip.add_to(command, "csx600");
  command.add_flag("--presets", state->presets, "Print the presets and what they change instead");
  command.add_flag("--markdown", state->markdown, "Print Markdown tables instead")->excludes("--presets");
  state->outputs.add_to(command, "--json", "Also write the parameters and options to this file");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
