#pragma once

#include <CLI/CLI.hpp>

namespace testbench {

/// Each adds one subcommand to the command line; its work runs from the subcommand's callback and throws
/// InputError or RunError.
void add_render_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_reproduce_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_params_command(CLI::App& app);
void add_scene_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_validate_command(CLI::App& app);
void add_waves_command(CLI::App& app);
void add_sweep_command(CLI::App& app);
void add_inject_command(CLI::App& app);
void add_sensitivity_command(CLI::App& app);
void add_estimate_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_stats_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_golden_command(CLI::App& app);

/// What these print describes every subcommand, those that were added later, too.
void add_completion_command(CLI::App& app);
void add_man_command(CLI::App& app);

}  // namespace testbench
