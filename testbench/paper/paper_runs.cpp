#include "testbench/paper/paper_runs.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::json;

double seconds_per_million_segments(const Scene& scene, const RenderOptions& options) {
  const RenderResult result = render_on_chip(scene, options);
  return result.chip->seconds() * 1e6 / double(result.counts.segments);
}

}  // namespace

std::vector<double> run_paper_cells(const Scene& scene, const RenderOptions& options,
                                    const std::vector<PaperCell>& cells, int at_once,
                                    const std::function<void(double)>& done) {
  const std::vector<PaperCell> runs = distinct_runs(cells);
  std::vector<std::function<std::string()>> jobs;
  for (const PaperCell& run : runs) {
    RenderOptions of_run = options;
    of_run.program = run.firmware(options.program);
    jobs.emplace_back([&scene, of_run] { return Json(seconds_per_million_segments(scene, of_run)).dump(); });
  }
  const std::vector<std::string> results = run_in_processes(jobs, at_once, [&](int finished) {
    if (done) done(finished / double(jobs.size()));
  });
  std::vector<double> seconds;
  for (const PaperCell& cell : cells) {
    const auto run = std::find_if(runs.begin(), runs.end(),
                                  [&](const PaperCell& other) { return cell.is_same_run(other); });
    seconds.push_back(Json::parse(results[std::size_t(run - runs.begin())]).get<double>());
  }
  return seconds;
}

}  // namespace testbench
