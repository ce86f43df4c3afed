#pragma once

#include <CLI/CLI.hpp>

namespace testbench {

/// Each adds one subcommand to `csx600 bench`.
void add_bench_speed_command(CLI::App& bench);
void add_bench_timing_command(CLI::App& bench);

}  // namespace testbench
