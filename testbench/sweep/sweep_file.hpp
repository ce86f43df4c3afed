#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "testbench/run/run_settings.hpp"
#include "testbench/sweep/expression.hpp"

namespace testbench {

/// Keys that change together; the axes of a sweep are multiplied.
struct SweepAxis {
  std::vector<std::string> keys;
  std::vector<std::vector<Setting>> steps;  ///< in each, one setting a key
};

/// An expression over columns, under a name that the sweep's file gives it.
struct NamedExpression {
  std::string name;
  Expression expression;
  std::string unit = "-";
};

/// A sweep as its file says it:
///
///     scene = "../scenes/cornell_box"        # files: from where the sweep's own file lies
///     chip = "paper"                         # any key of a run or of the chip, one value
///     samples = 4
///     pio.setup_cycles = 200
///     audit.share = 0.05                     # of the replayed points, run in full as well
///     audit.seed = 1                         # which ones
///
///     [[axis]]
///     firmware.n = [0, 1, 2, 3]              # a list
///     [[axis]]
///     pio.per_pe_cycles = { from = 4, to = 60, step = 8 }
///     [[axis]]                               # keys of one axis change together
///     chip.pes = { from = 16, to = 1024, factor = 2 }
///     ddr.banks = { from = 1, to = 8, count = 7 }     # evenly; or geometric = true
///
/// In place of a scene, a firmware that was built outside this tree, with its own options:
///
///     firmware = "libsaxpy.so"               # or the name of one that was installed with the program
///     [[axis]]
///     option.blocks = [1, 8, 64]
///
/// What must hold of a point, and columns made of others, are expressions (expression.hpp) over parameters of
/// chip and run, and over results:
///
///     [constraint]
///     sram = "chip.pes * poly.sram_bytes <= 589824"   # over parameters alone: other points are not run
///     power = "chip.energy.chip_watts <= 12"          # over results: other points are marked
///     [derived]
///     nanojoules_a_ray = "chip.energy.joules / rays * 1e9"
///     rays_a_clock = { expression = "rays / simulated_cycles", unit = "rays/cycle" }
struct SweepFile {
  std::string path;
  std::vector<Setting> base;
  std::vector<SweepAxis> axes;
  std::vector<NamedExpression> constraints;
  std::vector<NamedExpression> derived;
  double audit_share = 0.05;
  std::uint64_t audit_seed = 1;

  std::vector<std::string> keys() const;  ///< of all axes, in order
  std::uint64_t points() const;
};

inline constexpr std::uint64_t kMostSweepPoints = 1'000'000;

/// Throws InputError for an old or unknown key and for a value that is not allowed. Options of a firmware
/// outside this tree are left to Sweep, which loads it.
void require_setting(const Setting& setting);

/// Throws InputError that names the file, the line, the key, what was found and what is allowed.
SweepFile load_sweep_file(const std::string& path);

}  // namespace testbench
