#pragma once

#include <array>
#include <string>
#include <vector>

#include "firmware/path_tracer/program/program.hpp"
#include "testbench/run/program_names.hpp"

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

/// A number of the tables: a row and a program.
struct PaperCell {
  std::size_t row;
  path_tracer::Program program;

  double seconds() const { return paper_rows()[row].seconds[std::size_t(program)]; }
  /// The firmware that the cell is measured with; `base` gives what the tables leave open.
  path_tracer::ProgramConfig firmware(path_tracer::ProgramConfig base) const;
  /// Whether the same run gives both cells: buffering nothing is n = 0, whatever n says.
  bool is_same_run(const PaperCell& other) const;
  /// "segments, n = 0"
  std::string name() const;
};

/// All 24, row by row.
std::vector<PaperCell> paper_cells();

/// The cells that the preset `paper` was fitted to (`csx600 calibrate`); all others are predicted.
std::vector<PaperCell> fitted_cells();
bool is_fitted(const PaperCell& cell);

/// How far measured seconds are from the paper's, over the cells that were not fitted; relative.
struct PredictionError {
  double mean = 0;
  double worst = 0;
  int cells = 0;
};
/// @param seconds of all 24 cells, each on one of `chips` chips that share the paper's work
PredictionError prediction_error(const std::vector<double>& seconds, int chips = 1);

/// The firmware as the paper is read: one shadow ray for every segment, whichever way it goes ("a single
/// shadow ray per path segment"). The paper states neither the length of its bins nor when roulette begins:
/// bins of 8 blocks, and roulette late, because radiance takes below 1 % only when paths are long.
path_tracer::ProgramConfig paper_program();

/// The image (paper, figure 4): 480 x 480, 1000 segments a pixel.
inline constexpr double kPaperImageSegments = 480.0 * 480.0 * 1000.0;
inline constexpr double kPaperImageSeconds = 3036.37;

/// The share of radiance in the full computation, n = 1; `seconds` of all 24 cells.
double radiance_share(const std::vector<double>& seconds);

/// Path segments a second of the silicon with double buffering: the n = 1 row.
double silicon_segments_per_second(path_tracer::Program program);

}  // namespace testbench
