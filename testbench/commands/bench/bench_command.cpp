#include "testbench/commands/bench/bench_command.hpp"

#include "testbench/commands/commands.hpp"

namespace testbench {

void add_bench_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("bench", "Measure how good and how fast the renderer is");
  command.require_subcommand(1);
  add_bench_speed_command(command);
  add_bench_timing_command(command);
  add_bench_board_command(command);
  add_bench_reference_command(command);
  add_bench_error_command(command);
  add_bench_skips_command(command);
  add_bench_image_command(command);
  add_bench_adaptive_command(command);
  add_bench_rivals_command(command);
}

}  // namespace testbench
