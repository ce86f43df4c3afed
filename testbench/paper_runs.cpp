#include "testbench/paper_runs.hpp"

#include <nlohmann/json.hpp>

#include "testbench/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::json;

path_tracer::ProgramConfig program_of(const PaperCell& cell, path_tracer::ProgramConfig program) {
  const PaperRow& row = paper_rows()[cell.row];
  program.program = cell.program;
  program.buffer_loads = row.buffer_loads;
  program.buffer_saves = row.buffer_saves;
  // Buffering nothing is n = 0 whatever n says.
  program.n = row.buffer_loads || row.buffer_saves ? row.n : 0;
  return program;
}

bool runs_alike(const path_tracer::ProgramConfig& a, const path_tracer::ProgramConfig& b) {
  return a.program == b.program && a.load_buffers() == b.load_buffers() &&
         a.save_buffers() == b.save_buffers();
}

double seconds_per_million_segments(const Scene& scene, const RenderOptions& options) {
  const RenderResult result = render_on_chip(scene, options);
  return result.chip->seconds() * 1e6 / double(result.counts.segments);
}

}  // namespace

std::vector<double> run_paper_cells(const Scene& scene, const RenderOptions& options,
                                    const std::vector<PaperCell>& cells, int at_once,
                                    const std::function<void(double)>& done) {
  std::vector<RenderOptions> runs;
  std::vector<std::size_t> run_of_cell;
  for (const PaperCell& cell : cells) {
    RenderOptions of_cell = options;
    of_cell.program = program_of(cell, options.program);
    std::size_t run = 0;
    while (run < runs.size() && !runs_alike(runs[run].program, of_cell.program)) ++run;
    if (run == runs.size()) runs.push_back(of_cell);
    run_of_cell.push_back(run);
  }
  std::vector<std::function<std::string()>> jobs;
  for (const RenderOptions& run : runs)
    jobs.emplace_back([&scene, &run] { return Json(seconds_per_million_segments(scene, run)).dump(); });
  const std::vector<std::string> results = run_in_processes(jobs, at_once, [&](int finished) {
    if (done) done(finished / double(jobs.size()));
  });
  std::vector<double> seconds;
  for (const std::size_t run : run_of_cell) seconds.push_back(Json::parse(results[run]).get<double>());
  return seconds;
}

}  // namespace testbench
