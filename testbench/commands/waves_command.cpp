#include <cstdio>

#include "model/waves/wave_signals.hpp"
#include "testbench/commands/commands.hpp"

namespace testbench {

void add_waves_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("waves", "List the signals that `render --waves` can show");
  command.callback([] { std::fputs(model::wave_signal_markdown().c_str(), stdout); });
}

}  // namespace testbench
