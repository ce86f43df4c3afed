#include "testbench/benchmark/rivals.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <numeric>

#include "firmware/path_tracer/program/program_options.hpp"
#include "model/config/chip_parameters.hpp"
#include "testbench/benchmark/formatted.hpp"
#include "testbench/run/traversal_choice.hpp"
#include "testbench/scene_file/generated_scene.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using Json = nlohmann::json;
using path_tracer::Traversal;

/// As many rays are under way in all at every width from 16 on. For narrower arrays a PE has no room for the
/// addresses that it keeps for each block.
constexpr int kSlots = 1536;
constexpr int kMostBlocks = 96;

/// Lengths of paths whose runs tell the costs: a segment is the difference to paths one shorter.
constexpr int kLengths[] = {1, 2, 3, 5, 6};

/// A column of the table.
struct Coherence {
  const char* name;
  double RivalCosts::*cycles;
};
constexpr Coherence kCoherence[] = {{"1st, in tiles", &RivalCosts::first},
                                    {"1st, shuffled", &RivalCosts::first_shuffled},
                                    {"2nd segment", &RivalCosts::second},
                                    {"3rd segment", &RivalCosts::third},
                                    {"6th segment", &RivalCosts::sixth}};

struct RunTotals {
  double cycles = 0;
  double rays = 0;
};

/// No path lives longer than `segments`.
void end_rival_paths_after(int segments, path_tracer::ProgramConfig& program) {
  program.roulette_start = segments - 1;
  program.max_survival = 1e-300;
}

using Samples = std::vector<path_tracer::CameraSampleRecord>;

/// Interleaves the bits of a pixel's coordinates: pixels in this order fill squares of every size.
std::uint32_t place_on_z_curve(int x, int y) {
  std::uint32_t place = 0;
  for (int bit = 0; bit < 16; ++bit)
    place |= (std::uint32_t(x) >> bit & 1) << (2 * bit) | (std::uint32_t(y) >> bit & 1) << (2 * bit + 1);
  return place;
}

/// Every sample of every pixel, tile by tile: what suits packets best.
Samples samples_in_tiles(FilmSize film, int samples) {
  std::vector<std::pair<std::uint32_t, int>> pixels;
  for (int y = 0; y < film.height; ++y)
    for (int x = 0; x < film.width; ++x) pixels.emplace_back(place_on_z_curve(x, y), y * film.width + x);
  std::sort(pixels.begin(), pixels.end());
  Samples list;
  for (int sample = 0; sample < samples; ++sample)
    for (const auto& [place, pixel] : pixels) list.push_back({pixel, sample});
  return list;
}

/// The same samples, neighbours about a golden section of the film apart.
Samples samples_shuffled(const Samples& list) {
  const auto count = list.size();
  std::size_t stride = std::max<std::size_t>(1, std::size_t(std::lround(double(count) * 0.6180339887)));
  while (std::gcd(stride, count) != 1) ++stride;
  Samples shuffled;
  for (std::size_t i = 0, next = 0; i < count; ++i, next = (next + stride) % count)
    shuffled.push_back(list[next]);
  return shuffled;
}

/// The runs of one row: shuffled camera rays, then each of kLengths.
std::vector<RenderOptions> runs_of_row(const RivalCosts& row, const Scene& scene, const RenderOptions& base) {
  RenderOptions options = base;
  try {
    model::set_parameter(options.chip, "chip.pes", std::to_string(row.width), "--widths");
  } catch (const model::ConfigError& error) {
    throw InputError(error.what());
  }
  options.program.program = path_tracer::Program::segments;
  options.program.bin_blocks = std::clamp(kSlots / row.width, 2, kMostBlocks);
  options.program.traversal = row.traversal;
  options.camera_samples = samples_in_tiles(scene.film, base.work.samples);
  choose_tree(TriangleCount(scene), options.chip, {"traversal"}, options.program);
  std::vector<RenderOptions> runs;
  for (const int length : kLengths) {
    runs.push_back(options);
    end_rival_paths_after(length, runs.back().program);
  }
  runs.insert(runs.begin(), runs.front());
  runs.front().camera_samples = samples_shuffled(options.camera_samples);
  return runs;
}

std::string run_rival(const Scene& scene, const RenderOptions& options) {
  const RenderResult result = render_on_chip(scene, options);
  return Json{result.chip->firmware_cycles, result.counts.segments}.dump();
}

/// @param runs the totals of runs_of_row()
void set_costs(const std::vector<RunTotals>& runs, RivalCosts& row) {
  const auto a_ray = [](const RunTotals& run) { return run.cycles / run.rays; };
  const auto segment = [](const RunTotals& longer, const RunTotals& shorter) {
    return (longer.cycles - shorter.cycles) / (longer.rays - shorter.rays);
  };
  row.first_shuffled = a_ray(runs[0]);
  row.first = a_ray(runs[1]);
  row.second = segment(runs[2], runs[1]);
  row.third = segment(runs[3], runs[2]);
  row.sixth = segment(runs[5], runs[4]);
}

/// From which column on the binned way stays cheaper.
const char* overtakes_text(const RivalCosts& binned, const RivalCosts& rival) {
  const char* from = nullptr;
  for (const Coherence& column : kCoherence) {
    const bool is_cheaper = binned.*column.cycles < rival.*column.cycles;
    if (is_cheaper && from == nullptr) from = column.name;
    if (!is_cheaper) from = nullptr;
  }
  return from == nullptr ? "never" : from;
}

using Rows = std::vector<RivalCosts>;

std::string table_text(const Rows& rows) {
  std::string text = formatted("%d triangles, %d PEs: cycles a ray\n  %-16s", rows.front().triangles,
                               rows.front().width, "");
  for (const Coherence& column : kCoherence) text += formatted(" %14s", column.name);
  text += "\n";
  for (const RivalCosts& row : rows) {
    text += formatted("  %-16s", name_of(row.traversal));
    for (const Coherence& column : kCoherence) text += formatted(" %14.0f", row.*column.cycles);
    text += "\n";
  }
  for (std::size_t binned = 0; binned < kBinnedTraversals; ++binned) {
    text += formatted("  %s is cheaper from:", name_of(rows[binned].traversal));
    for (std::size_t rival = kBinnedTraversals; rival < rows.size(); ++rival)
      text += formatted(" than %s %s;", name_of(rows[rival].traversal),
                        overtakes_text(rows[binned], rows[rival]));
    text.back() = '\n';
  }
  return text;
}

}  // namespace

std::vector<RivalCosts> measure_rivals(const RivalsQuestion& question, int at_once,
                                       const std::function<void(double)>& done) {
  std::map<int, Scene> scenes;
  for (const int triangles : question.triangles) {
    scenes[triangles] = generate_scene(GeneratedScene::blob, triangles);
    scenes[triangles].film = question.film;
  }
  Rows rows;
  std::vector<std::function<std::string()>> jobs;
  std::size_t runs_a_row = 0;
  for (const int triangles : question.triangles)
    for (const int width : question.widths)
      for (const Traversal traversal : kComparedTraversals) {
        rows.push_back({triangles, width, traversal});
        const Scene& scene = scenes[triangles];
        const std::vector<RenderOptions> runs = runs_of_row(rows.back(), scene, question.options);
        runs_a_row = runs.size();
        for (const RenderOptions& run : runs)
          jobs.emplace_back([&scene, run] { return run_rival(scene, run); });
      }
  const std::vector<std::string> results = run_in_processes(jobs, at_once, [&](int finished) {
    if (done) done(finished / double(jobs.size()));
  });
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::vector<RunTotals> runs;
    for (std::size_t run = 0; run < runs_a_row; ++run) {
      const Json totals = Json::parse(results[i * runs_a_row + run]);
      runs.push_back({totals[0].get<double>(), totals[1].get<double>()});
    }
    set_costs(runs, rows[i]);
  }
  return rows;
}

std::string rivals_text(const std::vector<RivalCosts>& costs) {
  const std::size_t rows_a_table = kComparedTraversals.size();
  std::string text;
  for (auto row = costs.begin(); row != costs.end(); row += std::ptrdiff_t(rows_a_table)) {
    if (!text.empty()) text += "\n";
    text += table_text(Rows(row, row + std::ptrdiff_t(rows_a_table)));
  }
  return text;
}

std::string rivals_csv(const std::vector<RivalCosts>& costs) {
  std::string text = "triangles,pes,traversal,first,first_shuffled,second,third,sixth\n";
  for (const RivalCosts& row : costs)
    text += formatted("%d,%d,%s,%.2f,%.2f,%.2f,%.2f,%.2f\n", row.triangles, row.width, name_of(row.traversal),
                      row.first, row.first_shuffled, row.second, row.third, row.sixth);
  return text;
}

LogChart rivals_chart(const std::vector<RivalCosts>& costs) {
  const bool by_width = std::any_of(costs.begin(), costs.end(),
                                    [&](const RivalCosts& row) { return row.width != costs.front().width; });
  LogChart chart{"Ways through a tree: first segment, in tiles, and sixth",
                 by_width ? "PEs" : "triangles",
                 "cycles a ray",
                 {}};
  for (const Traversal traversal : kComparedTraversals)
    for (const Coherence& column : {kCoherence[0], kCoherence[4]}) {
      ChartSeries series{name_of(traversal) + std::string(", ") + column.name, {}, {}};
      for (const RivalCosts& row : costs) {
        if (row.traversal != traversal) continue;
        series.x.push_back(by_width ? row.width : row.triangles);
        series.y.push_back(row.*column.cycles);
      }
      chart.series.push_back(series);
    }
  return chart;
}

}  // namespace testbench
