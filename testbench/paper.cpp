#include "testbench/paper.hpp"

namespace testbench {

const std::vector<PaperRow>& paper_rows() {
  static const std::vector<PaperRow> rows = {
      {1, "n = 0", 0, true, true, {7.63, 16.84, 16.97}},  {1, "n = 1", 1, true, true, {5.94, 13.17, 13.28}},
      {1, "n = 2", 2, true, true, {5.94, 13.21, 13.36}},  {1, "n = 3", 3, true, true, {5.96, 13.46, 13.61}},
      {2, "none", 1, false, false, {7.63, 16.84, 16.97}}, {2, "loads", 1, true, false, {6.64, 14.81, 14.96}},
      {2, "saves", 1, false, true, {6.85, 15.49, 15.63}}, {2, "both", 1, true, true, {5.94, 13.17, 13.28}},
  };
  return rows;
}

double silicon_segments_per_second(path_tracer::Program program) {
  constexpr std::size_t kDoubleBuffered = 1;
  return 1e6 / paper_rows()[kDoubleBuffered].seconds[std::size_t(program)];
}

const char* program_name(path_tracer::Program program) {
  static constexpr std::array<const char*, 3> kNames = {"segments", "direct", "full"};
  return kNames[std::size_t(program)];
}

}  // namespace testbench
