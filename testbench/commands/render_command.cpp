#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "testbench/atomic_file.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/error.hpp"
#include "testbench/image_file.hpp"
#include "testbench/interrupt.hpp"
#include "testbench/progress_bar.hpp"
#include "testbench/render_report.hpp"
#include "testbench/scene/scene_file.hpp"
#include "testbench/statistics_file.hpp"

namespace testbench {
namespace {

struct RenderCommand {
  std::string scene;
  std::string size;
  RenderOptions options;
  ChipOptions chip;
  TimingOption timing;
  LevelOption level;
  std::string program = "full";
  std::string buffer = "both";
  std::string shadow_rays = "facing";
  bool native = false;
  std::string exr;
  std::string png;
  std::string statistics;
  bool statistics_text_wanted = false;
  std::string vcd;
  std::string vcd_cycles;

  void run();

 private:
  void require_writable_outputs() const;
  RenderRequest make_request() const;
  void write_outputs(const RenderRequest& request, const RenderResult& result) const;
};

/// "first:last", either may be missing.
void parse_cycles(const std::string& text, WaveOptions& waves) {
  const std::size_t colon = text.find(':');
  const auto number = [&](const std::string& part, std::uint64_t missing) {
    if (part.empty()) return missing;
    std::size_t used = 0;
    std::uint64_t value = 0;
    try {
      value = std::stoull(part, &used);
    } catch (const std::exception&) {
      used = 0;
    }
    if (used != part.size() || part[0] == '-')
      throw InputError("--vcd-cycles: found '" + text + "', allowed is FIRST:LAST");
    return value;
  };
  if (colon == std::string::npos)
    throw InputError("--vcd-cycles: found '" + text + "', allowed is FIRST:LAST");
  waves.first_cycle = number(text.substr(0, colon), 0);
  waves.last_cycle = number(text.substr(colon + 1), waves.last_cycle);
}

void RenderCommand::require_writable_outputs() const {
  require_files_of_their_own({{"--exr", exr}, {"--png", png}, {"--stats", statistics}, {"--vcd", vcd}});
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
  if (!vcd.empty()) {
    if (native) throw InputError("--vcd: a native run has no clock and so no waves; leave out --native");
    WaveOptions waves;
    waves.vcd = vcd;
    if (!vcd_cycles.empty()) parse_cycles(vcd_cycles, waves);
    request.options.waves = waves;
  } else if (!vcd_cycles.empty()) {
    throw InputError("--vcd-cycles: found without --vcd, allowed is together with it");
  }
  return request;
}

void RenderCommand::write_outputs(const RenderRequest& request, const RenderResult& result) const {
  if (!exr.empty()) write_exr(exr, result.film, render_provenance(request, result));
  if (!png.empty()) write_png(png, result.film);
  if (!statistics.empty())
    write_bytes_atomically(statistics, statistics_for_file(statistics, render_statistics(request, result)));
  if (statistics_text_wanted) std::fputs(statistics_text(render_statistics(request, result)).c_str(), stdout);
}

void RenderCommand::run() {
  const RenderRequest request = make_request();
  require_writable_outputs();
  if (request.options.waves) require_writable_waves(*request.options.waves);
  const Scene loaded = load_scene_for_film(scene, size);
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
  add_sampling_options(command, program);
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
  command.add_option("--vcd", state->vcd, "Write waves (.vcd) and a GTKWave view beside them (.gtkw)");
  command.add_option("--vcd-cycles", state->vcd_cycles, "Cycles to show as waves, FIRST:LAST (default: all)");
  command.callback([state] { state->run(); });
}

}  // namespace testbench
