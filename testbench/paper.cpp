#include "testbench/paper.hpp"

#include <algorithm>

namespace testbench {
namespace {

using path_tracer::Program;

constexpr std::size_t kUnbufferedRow = 0;
constexpr std::size_t kDoubleBufferedRow = 1;

}  // namespace

const std::vector<PaperRow>& paper_rows() {
  static const std::vector<PaperRow> rows = {
      {1, "n = 0", 0, true, true, {7.63, 16.84, 16.97}},  {1, "n = 1", 1, true, true, {5.94, 13.17, 13.28}},
      {1, "n = 2", 2, true, true, {5.94, 13.21, 13.36}},  {1, "n = 3", 3, true, true, {5.96, 13.46, 13.61}},
      {2, "none", 1, false, false, {7.63, 16.84, 16.97}}, {2, "loads", 1, true, false, {6.64, 14.81, 14.96}},
      {2, "saves", 1, false, true, {6.85, 15.49, 15.63}}, {2, "both", 1, true, true, {5.94, 13.17, 13.28}},
  };
  return rows;
}

std::string PaperCell::name() const {
  return std::string(program_name(program)) + ", " + paper_rows()[row].label;
}

std::vector<PaperCell> paper_cells() {
  std::vector<PaperCell> cells;
  for (std::size_t row = 0; row < paper_rows().size(); ++row)
    for (const Program program : kPaperPrograms) cells.push_back({row, program});
  return cells;
}

std::vector<PaperCell> fitted_cells() {
  return {{kDoubleBufferedRow, Program::segments},
          {kUnbufferedRow, Program::segments},
          {kDoubleBufferedRow, Program::direct}};
}

bool is_fitted(const PaperCell& cell) {
  const PaperRow& row = paper_rows()[cell.row];
  const std::vector<PaperCell> fitted = fitted_cells();
  return std::any_of(fitted.begin(), fitted.end(), [&](const PaperCell& other) {
    const PaperRow& other_row = paper_rows()[other.row];
    const bool buffered = row.n > 0 && (row.buffer_loads || row.buffer_saves);
    const bool other_buffered = other_row.n > 0;
    return other.program == cell.program && buffered == other_buffered &&
           (!buffered || (row.n == other_row.n && row.buffer_loads && row.buffer_saves));
  });
}

path_tracer::ProgramConfig paper_program() {
  path_tracer::ProgramConfig program;
  program.bin_blocks = 8;
  program.roulette_start = 8;
  program.cull_shadow_rays = false;
  return program;
}

double silicon_segments_per_second(Program program) {
  return 1e6 / paper_rows()[kDoubleBufferedRow].seconds[std::size_t(program)];
}

const char* program_name(Program program) {
  static constexpr std::array<const char*, 3> kNames = {"segments", "direct", "full"};
  return kNames[std::size_t(program)];
}

}  // namespace testbench
