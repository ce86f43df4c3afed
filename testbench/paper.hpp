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

/// Coulthurst et al. 2008, section 4.1.
const std::vector<PaperRow>& paper_rows();

/// Path segments a second of the silicon with double buffering: the n = 1 row.
double silicon_segments_per_second(path_tracer::Program program);

const char* program_name(path_tracer::Program program);

}  // namespace testbench
