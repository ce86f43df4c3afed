#include <cstdio>
#include <memory>

#include "testbench/commands/commands.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/plug_in/shared_library.hpp"
#include "testbench/statistics/counters.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

struct StatsCommand {
  std::string file;
  OutputFiles outputs;
  bool describe = false;
  std::string firmware;

  void run() const {
    if (describe != file.empty())
      throw InputError("stats: found " + std::string(describe ? "a file and --describe" : "neither") +
                       ", allowed is either a statistics file or --describe");
    if (!describe && !firmware.empty())
      throw InputError("--firmware: found without --describe, allowed is with it");
    if (describe) {
      const std::string own = describe_own_counters();
      std::fputs((describe_counters() + own).c_str(), stdout);
      return;
    }
    outputs.require_writable();
    outputs.require_no_input({{"the statistics", file}});
    const std::string& output = outputs.path("--output");
    const nlohmann::ordered_json statistics = read_statistics(file);
    if (output.empty()) std::fputs(statistics_text(statistics).c_str(), stdout);
    outputs.write("--output", [&] { return statistics_for_file(output, statistics); });
  }

 private:
  /// Of the firmware that was named.
  std::string describe_own_counters() const {
    if (firmware.empty()) return "";
    const SharedLibrary library(firmware);
    return describe_counters(*library.make(library.choose_level(std::nullopt)));
  }
};

}  // namespace

void add_stats_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("stats", "Print a run's statistics, or what they mean");
  const auto state = std::make_shared<StatsCommand>();
  command
      .add_option("file", state->file, "Statistics that render --stats or run --stats has written as JSON")
      ->type_name("FILE");
  command.add_flag("--describe", state->describe, "Print name, unit and meaning of every counter instead");
  command
      .add_option("--firmware", state->firmware,
                  "With --describe, the counters of this firmware's own, too; as csx600 run takes it")
      ->type_name("LIBRARY");
  state->outputs.add_to(command, "-o,--output", "Write them to this .csv, .txt or .json file instead");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
