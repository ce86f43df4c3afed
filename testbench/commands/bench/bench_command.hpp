#pragma once

#include <CLI/CLI.hpp>

namespace testbench {

/// The seed of references, so that they share no random number with what is measured against them.
inline constexpr std::uint64_t kReferenceSeed = 20080812;

/// EXR attribute that holds the seed.
inline constexpr const char* kSeedAttribute = "csx600.seed";

/// Each adds one subcommand to `csx600 bench`.
void add_bench_reference_command(CLI::App& bench);
void add_bench_error_command(CLI::App& bench);
void add_bench_skips_command(CLI::App& bench);
void add_bench_image_command(CLI::App& bench);
void add_bench_adaptive_command(CLI::App& bench);
void add_bench_rivals_command(CLI::App& bench);
void add_bench_speed_command(CLI::App& bench);
void add_bench_timing_command(CLI::App& bench);
void add_bench_board_command(CLI::App& bench);

}  // namespace testbench
