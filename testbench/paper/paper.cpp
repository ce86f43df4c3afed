#include "testbench/paper/paper.hpp"

#include <algorithm>
#include <cmath>

#include "firmware/path_tracer/program/program_options.hpp"

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
  return std::string(name_of(program)) + ", " + paper_rows()[row].label;
}

path_tracer::ProgramConfig PaperCell::firmware(path_tracer::ProgramConfig base) const {
  const PaperRow& of = paper_rows()[row];
  base.program = program;
  base.n = of.n;
  base.buffer_loads = of.buffer_loads;
  base.buffer_saves = of.buffer_saves;
  return base;
}

bool PaperCell::is_same_run(const PaperCell& other) const {
  const path_tracer::ProgramConfig a = firmware({});
  const path_tracer::ProgramConfig b = other.firmware({});
  return a.program == b.program && a.load_buffers() == b.load_buffers() &&
         a.save_buffers() == b.save_buffers();
}

std::vector<PaperCell> paper_cells() {
  std::vector<PaperCell> cells;
  for (std::size_t row = 0; row < paper_rows().size(); ++row)
    for (const Program program : kPaperPrograms) cells.push_back({row, program});
  return cells;
}

std::vector<PaperCell> distinct_runs(const std::vector<PaperCell>& cells) {
  std::vector<PaperCell> runs;
  for (const PaperCell& cell : cells)
    if (std::none_of(runs.begin(), runs.end(), [&](const PaperCell& run) { return cell.is_same_run(run); }))
      runs.push_back(cell);
  return runs;
}

std::vector<PaperCell> fitted_cells() {
  return {{kDoubleBufferedRow, Program::segments},
          {kUnbufferedRow, Program::segments},
          {kDoubleBufferedRow, Program::direct}};
}

bool is_fitted(const PaperCell& cell) {
  const std::vector<PaperCell> fitted = fitted_cells();
  return std::any_of(fitted.begin(), fitted.end(),
                     [&](const PaperCell& other) { return cell.is_same_run(other); });
}

PredictionError prediction_error(const std::vector<double>& seconds) {
  PredictionError result;
  const std::vector<PaperCell> cells = paper_cells();
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (is_fitted(cells[i])) continue;
    const double error = std::abs(seconds[i] / cells[i].seconds() - 1);
    result.mean += error;
    result.worst = std::max(result.worst, error);
    ++result.cells;
  }
  result.mean /= result.cells;
  return result;
}

double radiance_share(const std::vector<double>& seconds) {
  const double* const double_buffered = &seconds[kPaperPrograms.size() * kDoubleBufferedRow];
  return 1 - double_buffered[std::size_t(Program::direct)] / double_buffered[std::size_t(Program::full)];
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

}  // namespace testbench
