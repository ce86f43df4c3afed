#include "testbench/paper/claim_runs.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "firmware/path_tracer/program/program_options.hpp"
#include "model/config/chip_parameters.hpp"
#include "model/config/chip_presets.hpp"
#include "testbench/paper/paper.hpp"
#include "testbench/run/chip_statistics.hpp"
#include "testbench/run/traversal_choice.hpp"
#include "testbench/system/processes.hpp"

namespace testbench {
namespace {

using path_tracer::Program;
using path_tracer::ProgramConfig;
using path_tracer::Traversal;
using Json = nlohmann::json;

/// Slots of the runs that compare widths: a multiple of each, so that as many paths are under
/// way in all; a PE keeps some bytes for each of its slots, which bounds it.
constexpr int kSlots = 1536;

/// No path lives longer than `segments`: roulette lets none go on.
void end_paths_after(int segments, ProgramConfig& program) {
  program.roulette_start = segments;
  program.max_survival = 1e-300;
}

/// About a golden section of the pixels, without a common divisor: neighbours in a block lie far apart.
int shuffling_stride(int pixels) {
  int stride = std::max(1, int(std::lround(pixels * 0.6180339887)));
  while (std::gcd(stride, pixels) != 1) ++stride;
  return stride;
}

/// A list of as many paths as the film has samples, all in pixels that lie `distance` apart: what selective
/// rendering hands to the firmware.
std::vector<path_tracer::CameraSampleRecord> selected_samples(int pixels, int samples, int distance) {
  std::vector<path_tracer::CameraSampleRecord> list;
  for (int sample = 0; sample < distance * samples; ++sample)
    for (int pixel = 0; pixel < pixels; pixel += distance) list.push_back({pixel, sample});
  return list;
}

class ClaimRunList {
 public:
  ClaimRunList(const ClaimScenes& scenes, const RenderOptions& base) : scenes_(scenes), base_(base) {}

  std::vector<ClaimRun> all() {
    add_tables();
    add_orders();
    add_lengths();
    add_widths();
    add_traversals();
    add_stream_processor();
    add_bidirectional();
    return std::move(runs_);
  }

 private:
  /// The 18 different cells of Tables 1 and 2: "segments, n = 0" and so on.
  void add_tables() {
    for (const PaperCell& cell : distinct_runs(paper_cells())) {
      RenderOptions options = base_;
      options.program = cell.firmware(base_.program);
      add(cell.name(), scenes_.box, options);
    }
  }

  /// Rays of neighbours in a block, rays from all over the film, and selected pixels.
  void add_orders() {
    const int pixels = scenes_.box.film.width * scenes_.box.film.height;
    RenderOptions options = of_program(Program::segments);
    options.program.pixel_stride = shuffling_stride(pixels);
    add("shuffled", scenes_.box, options);
    options = of_program(Program::segments);
    options.camera_samples = selected_samples(pixels, options.work.samples, 1);
    add("listed pixels", scenes_.box, options);
    options.camera_samples = selected_samples(pixels, options.work.samples, 16);
    add("selected pixels", scenes_.box, options);
    options = of_program(Program::segments);
    options.work.samples *= 2;
    add("twice the samples", scenes_.box, options);
  }

  void add_lengths() {
    for (const int segments : {1, 2, 4, 8}) {
      RenderOptions options = of_program(Program::segments);
      end_paths_after(segments, options.program);
      add("paths of " + std::to_string(segments), scenes_.box, options);
    }
  }

  void add_widths() {
    for (const int pes : {16, 32, 96, 256}) {
      RenderOptions options = of_program(Program::segments);
      set_width(pes, options);
      add("width " + std::to_string(pes), scenes_.box, options);
      options.chip = model::preset("csx600");
      set_width(pes, options);
      add("tuned width " + std::to_string(pes), scenes_.box, options);
      for (const Traversal traversal : {Traversal::packets, Traversal::temporary_bin}) {
        RenderOptions of_tree = options;
        set_tree(traversal, of_tree);
        add(name_of(traversal) + (" width " + std::to_string(pes)), scenes_.many_triangles, of_tree);
      }
    }
  }

  /// Ways through a tree, on the chip as tuned code sees it.
  void add_traversals() {
    RenderOptions options = of_program(Program::segments);
    options.chip = model::preset("csx600");
    add("brute_force", scenes_.many_triangles, options);
    for (const Traversal traversal :
         {Traversal::packets, Traversal::temporary_bin, Traversal::refill, Traversal::lock_step}) {
      RenderOptions of_tree = options;
      set_tree(traversal, of_tree);
      add(name_of(traversal), scenes_.many_triangles, of_tree);
      for (const int segments : {1, 2, 4, 8}) {
        if (traversal != Traversal::packets && traversal != Traversal::temporary_bin) break;
        RenderOptions of_length = of_tree;
        end_paths_after(segments, of_length.program);
        add(name_of(traversal) + (", paths of " + std::to_string(segments)), scenes_.many_triangles,
            of_length);
      }
    }
    for (const int nodes : {1, 2, 4, 8}) {
      RenderOptions of_tree = options;
      set_tree(Traversal::temporary_bin, of_tree, nodes);
      add("sub-tree of " + std::to_string(nodes), scenes_.many_triangles, of_tree);
    }
  }

  void add_stream_processor() {
    RenderOptions options = of_program(Program::segments);
    options.program.execution = path_tracer::Execution::stream;
    add("stream", scenes_.box, options);
  }
  void add_bidirectional() {
    RenderOptions options = of_program(Program::full);
    options.program.paths = path_tracer::Paths::bidirectional;
    options.program.cull_shadow_rays = true;
    add("bidirectional", scenes_.box, options);
  }

  RenderOptions of_program(Program program) const {
    RenderOptions options = base_;
    options.program.program = program;
    return options;
  }

  static void set_width(int pes, RenderOptions& options) {
    model::set_parameter(options.chip, "chip.pes", std::to_string(pes), "chip.pes");
    options.program.bin_blocks = kSlots / pes;
  }

  void set_tree(Traversal traversal, RenderOptions& options, int treelet_nodes = 0) const {
    options.program.traversal = traversal;
    GivenOptions given = {"traversal"};
    if (treelet_nodes > 0) {
      given.insert("treelet_nodes");
      options.program.tree.treelet_nodes = treelet_nodes;
    }
    choose_tree(TriangleCount(scenes_.many_triangles), options.chip, given, options.program);
  }

  void add(const std::string& name, const Scene& scene, const RenderOptions& options) {
    runs_.push_back({name, &scene, options});
  }

  const ClaimScenes& scenes_;
  const RenderOptions& base_;
  std::vector<ClaimRun> runs_;
};

std::string figures_of(const ClaimRun& run) {
  const RenderResult result = render_on_chip(*run.scene, run.options);
  Json json;
  json["cycles"] = result.chip->firmware_cycles;
  json["seconds"] = result.chip->seconds();
  json["counts"] = Json::parse(to_json(result.counts).dump());
  json["counts"]["segments"] = result.counts.segments;
  json["counts"]["shadow_rays"] = result.counts.shadow_rays;
  json["chip"] = Json::parse(to_json(*result.chip).dump());
  return json.dump();
}

}  // namespace

Json ClaimFigures::kernel(const std::string& name) const {
  for (const Json& kernel : chip()["pe_array"]["kernels"])
    if (kernel["name"] == name) return kernel;
  return {};
}

std::vector<ClaimRun> claim_runs(const ClaimScenes& scenes, const RenderOptions& options) {
  return ClaimRunList(scenes, options).all();
}

ClaimMeasurements measure_claims(const std::vector<ClaimRun>& runs, int at_once,
                                 const std::function<void(double)>& done) {
  std::vector<std::function<std::string()>> jobs;
  jobs.reserve(runs.size());
  for (const ClaimRun& run : runs) jobs.emplace_back([&run] { return figures_of(run); });
  const std::vector<std::string> results = run_in_processes(jobs, at_once, [&](int finished) {
    if (done) done(finished / double(jobs.size()));
  });
  ClaimMeasurements measurements;
  for (std::size_t i = 0; i < runs.size(); ++i) measurements.add(runs[i].name, Json::parse(results[i]));
  return measurements;
}

}  // namespace testbench
