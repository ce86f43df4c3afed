#pragma once

#include <array>
#include <vector>

#include "firmware/path_tracer/program.hpp"

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

/// The cell that the preset `paper` was fitted to (model/chip_presets.cpp); all others are predicted.
inline constexpr int kFittedN = 1;
inline constexpr path_tracer::Program kFittedProgram = path_tracer::Program::segments;

/// Coulthurst et al. 2008, section 4.1.
const std::vector<PaperRow>& paper_rows();

/// Path segments a second of the silicon with double buffering: the n = 1 row.
double silicon_segments_per_second(path_tracer::Program program);

const char* program_name(path_tracer::Program program);

}  // namespace testbench
