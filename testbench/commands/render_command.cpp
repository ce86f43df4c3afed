#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/wave_options.hpp"
#include "testbench/film/image_file.hpp"
#include "testbench/observe/observation.hpp"
#include "testbench/scene/scene_file.hpp"
#include "testbench/statistics/rank_render.hpp"
#include "testbench/statistics/render_report.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/system/atomic_file.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/interrupt.hpp"
#include "testbench/system/progress_bar.hpp"

namespace testbench {
namespace {

struct RenderCommand {
  std::string scene;
  std::string size;
  RenderOptions options;
  ChipOptions chip;
  TimingOption timing;
  LevelOption level;
  TraversalOption traversal;
  std::string program = "full";
  std::string buffer = "both";
  std::string shadow_rays = "facing";
  bool native = false;
  std::string exr;
  std::string png;
  std::string statistics;
  bool statistics_text_wanted = false;
  ObservationOption observation;

  void run();
  void run_on_ranks(Ranks& ranks);

 private:
  void require_writable_outputs() const;
  RenderRequest make_request() const;
  void write_outputs(const RenderRequest& request, const RenderResult& result) const;
};

void RenderCommand::require_writable_outputs() const {
  std::vector<OutputOption> outputs = observation.outputs();
  outputs.insert(outputs.end(), {{"--exr", exr}, {"--png", png}, {"--stats", statistics}});
  require_files_of_their_own(outputs);
  for (const std::string& path : {exr, png, statistics})
    if (!path.empty()) require_writable(path);
}

path_tracer::Program program_named(const std::string& name) {
  using path_tracer::Program;
  return name == "segments" ? Program::segments : name == "direct" ? Program::direct : Program::full;
}

RenderRequest RenderCommand::make_request() const {
  RenderRequest request{scene, options, native};
  request.options.program.program = program_named(program);
  request.options.chip = chip.chip();
  request.options.timing = timing.style();
  request.options.level = level.level();
  request.options.program.buffer_loads = buffer == "both" || buffer == "loads";
  request.options.program.buffer_saves = buffer == "both" || buffer == "saves";
  request.options.program.cull_shadow_rays = shadow_rays == "facing";
  if (native && request.options.timing == model::TimingStyle::approximately_timed)
    throw InputError("--timing: found at with --native, a native run has no clock; allowed is lt");
  if (native && observation.any())
    throw InputError(
        "--waves, --transactions, --timeline: a native run has no clock and so nothing to show; leave out "
        "--native");
  request.options.observation = observation.options(request.options.chip);
  return request;
}

void RenderCommand::write_outputs(const RenderRequest& request, const RenderResult& result) const {
  if (!exr.empty()) write_exr(exr, result.film, render_provenance(request, result));
  if (!png.empty()) write_png(png, result.film);
  if (!statistics.empty())
    write_bytes_atomically(statistics, statistics_for_file(statistics, render_statistics(request, result)));
  if (statistics_text_wanted) std::fputs(statistics_text(render_statistics(request, result)).c_str(), stdout);
}

/// Each rank renders its share of the samples on a machine of its own.
void RenderCommand::run_on_ranks(Ranks& ranks) {
  std::string error;
  RenderRequest request;
  std::optional<Scene> loaded;
  try {
    request = make_request();
    if (observation.any())
      throw InputError("--waves, --transactions, --timeline: found under mpirun; allowed: one process");
    if (ranks.is_first()) require_writable_outputs();
    loaded = load_scene_for_film(scene, size);
    request.traversal_reason = traversal.choose(*loaded, request.options.chip, request.options.program);
  } catch (const InputError& wrong) {
    error = wrong.what();
  }
  for (const std::string& of_rank : ranks.exchange(error))
    if (!of_rank.empty() && ranks.is_first())
      throw InputError(of_rank);
    else if (!of_rank.empty())
      return;
  const InterruptGuard interrupt;
  const std::optional<RankRender> render = [&] {
    std::optional<ProgressBar> bar;
    if (ranks.is_first()) bar.emplace("render (ranks)");
    return render_on_ranks(ranks, *loaded, request, [&](double share) {
      if (bar) bar->show(share);
      return !interrupt.requested();
    });
  }();
  if (!render) return;
  const std::map<std::string, std::string> provenance = {
      {"csx600.scene", scene},
      {"csx600.ranks", std::to_string(ranks.size())},
      {"csx600.segments", std::to_string(render->segments)},
      {"csx600.image_sha256", render->film.sha256()}};
  if (!exr.empty()) write_exr(exr, render->film, provenance);
  if (!png.empty()) write_png(png, render->film);
  if (!statistics.empty()) write_bytes_atomically(statistics, render->statistics.dump(2) + "\n");
  std::printf("%s, %d x %d, %d samples a pixel shared by %d ranks: %llu path segments", loaded->name.c_str(),
              loaded->film.width, loaded->film.height, request.options.work.samples, ranks.size(),
              static_cast<unsigned long long>(render->segments));
  if (render->simulated_seconds)
    std::printf(", %.6f s simulated on the chip that took longest", *render->simulated_seconds);
  std::printf(", %.2f s CPU\n", render->cpu_seconds);
}

void RenderCommand::run() {
  Ranks ranks;
  if (!ranks.alone()) return run_on_ranks(ranks);
  RenderRequest request = make_request();
  require_writable_outputs();
  require_writable(request.options.observation, request.options.chip);
  const Scene loaded = load_scene_for_film(scene, size);
  request.traversal_reason = traversal.choose(loaded, request.options.chip, request.options.program);
  const InterruptGuard interrupt;
  const RenderResult result = [&] {
    ProgressBar bar(native ? "render (native)" : "render");
    const auto progress = [&](double share) {
      bar.show(share);
      return !interrupt.requested();
    };
    return native ? render_natively(loaded, request.options, progress)
                  : render_on_chip(loaded, request.options, progress);
  }();
  write_outputs(request, result);
  if (loaded.degenerate_triangles > 0)
    std::fprintf(stderr, "note: %s: %zu triangles without area were left out\n", scene.c_str(),
                 loaded.degenerate_triangles);
  std::printf("%s, %d x %d, %d samples a pixel, program %s, n = %d, buffering %s, %s\n", loaded.name.c_str(),
              loaded.film.width, loaded.film.height, request.options.work.samples, program.c_str(),
              request.options.program.n, buffer.c_str(),
              native ? "native" : request.options.chip.preset.c_str());
  std::fputs(render_table(request, result).c_str(), stdout);
  if (exr.empty() && png.empty()) std::puts("  no image written: name one with --exr or --png");
  require_observed(result);
}

void add_firmware_options(CLI::App& command, RenderCommand& state) {
  path_tracer::ProgramConfig& program = state.options.program;
  command.add_option("--program", state.program, "What is timed: segments, direct or full")
      ->check(CLI::IsMember({"segments", "direct", "full"}))
      ->capture_default_str();
  command.add_option("--n", program.n, "Blocks loaded ahead and saved behind, 0 to 8")->capture_default_str();
  command.add_option("--buffer", state.buffer, "What is n-buffered: loads, saves, both or none")
      ->check(CLI::IsMember({"loads", "saves", "both", "none"}))
      ->capture_default_str();
  command
      .add_option("--shadow-rays", state.shadow_rays,
                  "Cast them only where light and surface face each other, or all: facing or all")
      ->check(CLI::IsMember({"facing", "all"}))
      ->capture_default_str();
  command.add_option("--bin-blocks", program.bin_blocks, "Length of each bin in blocks of one SIMD width")
      ->capture_default_str();
  command.add_option("--slot-vertices", program.slot_vertices, "Vertices that a path slot holds")
      ->capture_default_str();
  command
      .add_option(
          "--pixel-stride", program.pixel_stride,
          "Pixels from one camera ray to the next: 1 in order, more to shuffle; the image is the same")
      ->capture_default_str();
  add_sampling_options(command, program);
  state.traversal.add_to(command, program);
}

}  // namespace

void add_render_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("render", "Render a scene with the firmware on the chip");
  const auto state = std::make_shared<RenderCommand>();
  state->options.work.samples = 16;
  choose_best_sampling(state->options.program);
  command.add_option("scene", state->scene, "Directory with a scene.toml, or a .toml file")->required();
  command.add_option("--samples", state->options.work.samples, "Paths a pixel")
      ->check(CLI::Range(1, 1 << 30))
      ->capture_default_str();
  command.add_option("--size", state->size, "Film in pixels, WIDTHxHEIGHT (default: the scene's)");
  add_firmware_options(command, *state);
  state->chip.add_to(command, "csx600");
  state->timing.add_to(command);
  state->level.add_to(command);
  command.add_flag("--native", state->native, "Run the firmware without SystemC: same image, no time");
  add_check_hazards_flag(command, state->options.check_hazards);
  command.add_option("--exr", state->exr, "Write the image as OpenEXR");
  command.add_option("--png", state->png, "Write the image as PNG");
  command.add_option("--stats,--json", state->statistics,
                     "Write statistics: as CSV or text to a .csv or .txt file, otherwise as JSON");
  command.add_flag("--stats-text", state->statistics_text_wanted, "Print the statistics");
  state->observation.add_to(command);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
