#pragma once

#include <array>
#include <string>
#include <vector>

#include "firmware/path_tracer/program/program_config.hpp"

namespace testbench {

/// A row of the paper's Table 1 or 2: seconds for 1,000,000 path segments, by program.
struct PaperRow {
  int table;
  const char* label;
  int n;
  bool buffer_loads;
  bool buffer_saves;
  std::array<double, 3> seconds;  ///< segments, direct, full
};

/// Coulthurst et al. 2008, section 4.1. The rows "none" and "both" of Table 2 repeat n = 0 and n = 1 of
/// Table 1.
const std::vector<PaperRow>& paper_rows();

inline constexpr std::array<path_tracer::Program, 3> kPaperPrograms = {
    path_tracer::Program::segments, path_tracer::Program::direct, path_tracer::Program::full};

/// A cell of the tables: a row and a program.
struct PaperCell {
  std::size_t row;
  path_tracer::Program program;

  double seconds() const { return paper_rows()[row].seconds[std::size_t(program)]; }
  /// The configuration of the firmware for this cell. `base` gives what the tables leave open.
  path_tracer::ProgramConfig firmware(path_tracer::ProgramConfig base) const;
  /// Whether one run measures both cells. Without buffered loads and saves every n is the same as n = 0.
  bool is_same_run(const PaperCell& other) const;
  /// For example "segments, n = 0".
  std::string name() const;
};

/// All 24 cells, row by row.
std::vector<PaperCell> paper_cells();

/// The first of all cells that one run measures, in their order: 18 of paper_cells().
std::vector<PaperCell> distinct_runs(const std::vector<PaperCell>& cells);

/// The cells that the preset `paper` was fitted to (`csx600 calibrate`); all others are predicted.
std::vector<PaperCell> fitted_cells();
bool is_fitted(const PaperCell& cell);

/// Relative error of measured seconds against the paper's, over the cells that were not fitted.
struct PredictionError {
  double mean = 0;
  double worst = 0;
  int cells = 0;
};
/// @param seconds seconds of all 24 cells
PredictionError prediction_error(const std::vector<double>& seconds);

/// The firmware of the paper as this project reads it: one shadow ray for every segment, whatever its
/// direction ("a single shadow ray per path segment"). The paper states neither the length of its bins nor
/// where roulette begins. Bins have 8 blocks here, and roulette begins late, because radiance takes less than
/// 1 % of the time only if paths are long.
path_tracer::ProgramConfig paper_program();

/// The image (paper, figure 4): 480 x 480 pixels, 1000 segments per pixel.
inline constexpr double kPaperImageSegments = 480.0 * 480.0 * 1000.0;
inline constexpr double kPaperImageSeconds = 3036.37;

/// The share of radiance in the time of the full computation at n = 1.
/// @param seconds seconds of all 24 cells
double radiance_share(const std::vector<double>& seconds);

/// Path segments per second of the silicon with double buffering (row n = 1).
double silicon_segments_per_second(path_tracer::Program program);

}  // namespace testbench
