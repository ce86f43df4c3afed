#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "testbench/commands/command_options.hpp"
#include "testbench/commands/commands.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/commands/sampling_options.hpp"
#include "testbench/commands/wave_options.hpp"
#include "testbench/faults/fault_text.hpp"
#include "testbench/film/black_film.hpp"
#include "testbench/film/image_file.hpp"
#include "testbench/observe/observation.hpp"
#include "testbench/run/program_choice.hpp"
#include "testbench/run/render_job.hpp"
#include "testbench/run/simulator_choice.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/statistics/rank_render.hpp"
#include "testbench/statistics/render_report.hpp"
#include "testbench/statistics/statistics_file.hpp"
#include "testbench/sweep/point_store.hpp"
#include "testbench/system/digest.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/interrupt.hpp"
#include "testbench/system/progress_bar.hpp"
#include "testbench/system/standard_output.hpp"

namespace testbench {
namespace {

/// What all ranks have before they render.
struct PreparedRender {
  Scene scene;
  RenderRequest request;
  std::vector<double> importance;  ///< of each pixel
};

struct RenderCommand {
  SceneArgument scene;
  SizeOption size;
  RenderOptions options;
  ChipOptions chip;
  TimingOption timing;
  LevelOption level;
  FirmwareOptions firmware;
  bool native = false;
  bool firmware_search = false;  ///< natively, too
  OutputFiles outputs;
  bool statistics_text_wanted = false;
  std::vector<std::string> faults;
  ObservationOption observation;
  ImportanceOption importance;
  PassOptions passes;

  void run();
  void run_on_ranks(Ranks& ranks);
  void run_in_passes(Ranks& ranks);

 private:
  std::optional<PreparedRender> prepare(Ranks& ranks) const;
  RenderRequest make_request() const;
  std::string choose_tree_for(const Scene& loaded, RenderOptions& of) const;
  void suit_to(const Scene& loaded, RenderRequest& request) const;
  std::vector<InputName> inputs(const Scene& loaded) const;
  void list_samples(MeanSamples of_pixels, RenderRequest& request) const;
  void write_image(const Film& film, std::map<std::string, std::string> provenance, bool is_partial) const;
  void require_whole(bool is_partial, const Film& film, std::uint64_t paths) const;
  std::string checkpoint_identity(const PreparedRender& prepared) const;
};

RenderRequest RenderCommand::make_request() const {
  RenderRequest request{scene.path(), options, native};
  request.importance = importance.file();
  if (!passes.has_checkpoint()) passes.require_checkpoint();
  passes.budget(native);  // whether it is allowed
  request.options.chip = chip.chip();
  request.options.timing = timing.style();
  request.options.level = level.level();
  // An OpenEXR file has the variance, which is 0 of one sample.
  if (outputs.path("--exr").empty() || options.work.samples == 1) request.options.film_sums = FilmSums::means;
  if (passes.any()) request.options.film_sums = FilmSums::means_and_variances;
  if (native && request.options.timing == model::TimingStyle::approximately_timed)
    throw InputError("--timing: found at with --native, a native run has no clock; allowed is lt");
  if (native && observation.any())
    throw InputError(
        "--waves, --transactions, --timeline: a native run has no clock and records no waves; leave out "
        "--native");
  request.options.observation = observation.options(request.options.chip);
  for (const std::string& fault : faults) request.options.faults.push_back(fault_of(fault));
  if (native && !faults.empty())
    throw InputError("--fault: found with --native, which has no hardware to break; leave out one");
  require_faults(request.options);
  return request;
}

std::string RenderCommand::choose_tree_for(const Scene& loaded, RenderOptions& of) const {
  path_tracer::ProgramConfig of_chip = of.program;
  std::string reason = choose_program(loaded, of.chip, firmware.given(), of_chip);
  if (native && !firmware_search && firmware.given().count("traversal") == 0 && !of.check_hazards) {
    of_chip.traversal = of.program.traversal;
    of_chip.tree = of.program.tree;
    of.program = of_chip;
    return suit_to_simulator(firmware.given(), of);
  }
  of.program = of_chip;
  return reason;
}

/// What the request takes from its scene.
void RenderCommand::suit_to(const Scene& loaded, RenderRequest& request) const {
  request.triangles = loaded.triangles.size();
  request.traversal_reason = choose_tree_for(loaded, request.options);
}

std::vector<InputName> RenderCommand::inputs(const Scene& loaded) const {
  std::vector<InputName> inputs = inputs_of(chip, loaded);
  inputs.push_back(importance.input());
  return inputs;
}

/// The paths that an importance map asks for.
void RenderCommand::list_samples(MeanSamples of_pixels, RenderRequest& request) const {
  if (!importance.is_given()) return;
  for (double& samples : of_pixels) samples *= request.options.work.samples;
  const SampleCounts counts = counts_of(of_pixels, request.options.program.seed);
  require_list_memory(total(counts), request.options.chip);
  request.options.camera_samples =
      testbench::list_samples(SampleCounts(counts.size(), 0), counts, request.options.program.pixel_stride);
}

void RenderCommand::write_image(const Film& film, std::map<std::string, std::string> provenance,
                                bool is_partial) const {
  if (is_partial) provenance["csx600.partial"] = "true";
  if (!outputs.path("--exr").empty()) write_exr(outputs.path("--exr"), film, provenance);
  if (!outputs.path("--png").empty()) write_png(outputs.path("--png"), film);
}

/// Throws RunError, once everything is written, for a render that was interrupted.
/// @param paths that it should have had
void RenderCommand::require_whole(bool is_partial, const Film& film, std::uint64_t paths) const {
  if (!is_partial) return;
  const double done = film.samples().mean * film.pixel_count();
  char text[96];
  std::snprintf(text, sizeof(text), "interrupted after %.0f of %.0f paths", done, double(paths));
  std::string error = text;
  if (outputs.any()) error += "; what was written is marked partial";
  if (passes.has_checkpoint()) error += "; the same command with --resume goes on";
  throw RunError(error);
}

/// Build and importance. An importance map may change under its name.
std::string RenderCommand::checkpoint_identity(const PreparedRender& prepared) const {
  Sha256 digest;
  digest.add(build_digest(""));
  digest.add({reinterpret_cast<const char*>(prepared.importance.data()),
              prepared.importance.size() * sizeof(double)});
  return digest.finish();
}

void print_film_notes(const Scene& loaded, const Film& film, path_tracer::Program program) {
  const int without = film.samples().pixels_without;
  if (without > 0)
    print_note(std::to_string(without) + " of " + std::to_string(film.pixel_count()) +
               " pixels have no path and are black");
  const bool casts_shadow_rays = program != path_tracer::Program::segments;
  if (is_black(film))
    print_note("every pixel is black: " + why_black(loaded, casts_shadow_rays));
  else if (!casts_shadow_rays && !loaded.lights.empty())
    print_note("program segments casts no shadow rays: points, spots, suns and parallel light, " +
               std::to_string(loaded.lights.size()) + " in all, light no surface");
  if (is_below_single_precision(film))
    print_note(
        "every pixel is darker than 1.2e-38, of which the single precision of OpenEXR files keeps fewer "
        "digits, "
        "and below 1e-45 none");
}

/// What all ranks check before they render. An error is the first rank's to say; the others get nothing.
std::optional<PreparedRender> RenderCommand::prepare(Ranks& ranks) const {
  std::string error;
  std::optional<PreparedRender> prepared;
  try {
    RenderRequest request = make_request();
    if (!faults.empty())
      throw InputError("--fault: found with several passes or under mpirun; allowed: one pass, one process");
    if (observation.any())
      throw InputError("--waves, --transactions, --timeline: found " +
                       std::string(ranks.alone() ? "with several passes; allowed: one pass"
                                                 : "under mpirun; allowed: one process"));
    if (ranks.is_first()) outputs.require_writable({passes.checkpoint_output()});
    if (ranks.is_first()) passes.require_checkpoint();
    size.require_valid();
    Scene loaded = size.resized(scene.load());
    if (ranks.is_first()) outputs.require_no_input(inputs(loaded), {passes.checkpoint_output()});
    suit_to(loaded, request);
    std::vector<double> of_pixels = importance.importance(loaded.film, request.options.work.samples);
    if (!passes.any()) list_samples(of_pixels, request);
    if (ranks.is_first()) passes.prepare_snapshots();
    prepared = PreparedRender{std::move(loaded), std::move(request), std::move(of_pixels)};
  } catch (const InputError& wrong) {
    error = wrong.what();
  }
  for (const std::string& of_rank : ranks.exchange(error))
    if (!of_rank.empty() && ranks.is_first())
      throw InputError(of_rank);
    else if (!of_rank.empty())
      return std::nullopt;
  return prepared;
}

void print_head(const Scene& loaded, const RenderRequest& request) {
  std::printf("%s, %d x %d, %d samples a pixel, program %s, n = %d, buffering %s, %s\n",
              printable(loaded.name).c_str(), loaded.film.width, loaded.film.height,
              request.options.work.samples, name_of(request.options.program.program),
              request.options.program.n, option_text(request.options.program, "buffer").c_str(),
              request.native ? "native" : request.options.chip.preset.c_str());
}

/// Each rank renders its share of the samples on a machine of its own.
void RenderCommand::run_on_ranks(Ranks& ranks) {
  const auto prepared = prepare(ranks);
  if (!prepared) return;
  const Scene& loaded = prepared->scene;
  const RenderRequest& request = prepared->request;
  const InterruptGuard interrupt;
  const std::optional<RankRender> render = [&] {
    std::optional<ProgressBar> bar;
    if (ranks.is_first()) bar.emplace("render (ranks)");
    return render_on_ranks(ranks, loaded, request, [&](double share) {
      if (bar) bar->show(share);
      return !ranks.stop_requested();
    });
  }();
  if (!render) return;
  const std::map<std::string, std::string> provenance = {
      {"csx600.scene", scene.path()},
      {"csx600.ranks", std::to_string(ranks.size())},
      {"csx600.segments", std::to_string(render->segments)},
      {"csx600.image_sha256", render->film.sha256()}};
  write_image(render->film, provenance, render->is_partial);
  outputs.write("--stats", [&] { return statistics_json(render->statistics); });
  print_notes(loaded.notes);
  print_film_notes(loaded, render->film, request.options.program.program);
  std::printf("%s, %d x %d, %d samples a pixel shared by %d ranks: %llu path segments",
              printable(loaded.name).c_str(), loaded.film.width, loaded.film.height,
              request.options.work.samples, ranks.size(), static_cast<unsigned long long>(render->segments));
  if (render->simulated_seconds)
    std::printf(", %.6f s simulated on the chip that took longest", *render->simulated_seconds);
  std::printf(", %.2f s CPU\n", render->cpu_seconds);
  require_whole(render->is_partial, render->film, paths_of(loaded, request.options));
}

/// Each pass is shared by all ranks.
void RenderCommand::run_in_passes(Ranks& ranks) {
  const auto prepared = prepare(ranks);
  if (!prepared) return;
  const Scene& loaded = prepared->scene;
  const RenderRequest& request = prepared->request;
  const auto plan = passes.plan(prepared->importance, request.options.work.samples);
  const std::map<std::string, std::string> provenance = {{"csx600.scene", scene.path()},
                                                         {"csx600.importance", importance.file()}};
  const InterruptGuard interrupt;
  const std::optional<PassRender> render = [&] {
    std::optional<ProgressBar> bar;
    if (ranks.is_first()) bar.emplace("render (passes)");
    const PassActions actions{
        [&](const Film& film, int pass) { passes.write_snapshot(film, pass, provenance); },
        [&](double share) {
          if (bar) bar->show(share);
          return !ranks.stop_requested();
        },
        ranks.is_first() ? passes.checkpoint(checkpoint_identity(*prepared)) : std::nullopt};
    return render_in_passes(ranks, loaded, request, *plan, passes.budget(native), actions);
  }();
  if (!render) return;
  const bool is_partial = render->end == PassEnd::interrupted;
  if (is_partial && render->passes == 0) throw RunError("interrupted in the first pass; nothing was written");
  std::map<std::string, std::string> of_image = provenance;
  of_image["csx600.passes"] = std::to_string(render->passes);
  of_image["csx600.segments"] = std::to_string(render->segments);
  of_image["csx600.image_sha256"] = render->film.sha256();
  write_image(render->film, of_image, is_partial);
  outputs.write("--stats", [&] { return statistics_json(render->statistics); });
  print_notes(loaded.notes);
  print_film_notes(loaded, render->film, request.options.program.program);
  print_head(loaded, request);
  std::fputs(pass_table(*render, *plan).c_str(), stdout);
  require_whole(is_partial, render->film,
                std::uint64_t(total(prepared->importance) * request.options.work.samples));
}

void RenderCommand::run() {
  Ranks ranks;
  if (passes.any()) return run_in_passes(ranks);
  if (!ranks.alone()) return run_on_ranks(ranks);
  RenderRequest request = make_request();
  outputs.require_writable(observation.outputs());
  require_writable(request.options.observation, request.options.chip);
  size.require_valid();
  const Scene loaded = size.resized(scene.load());
  outputs.require_no_input(inputs(loaded), observation.outputs());
  suit_to(loaded, request);
  list_samples(importance.importance(loaded.film, request.options.work.samples), request);
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
  write_image(result.film, render_provenance(request, result), result.is_partial);
  outputs.write("--stats", [&] {
    return statistics_for_file(outputs.path("--stats"), render_statistics(request, result));
  });
  print_film_notes(loaded, result.film, request.options.program.program);
  if (statistics_text_wanted) std::fputs(statistics_text(render_statistics(request, result)).c_str(), stdout);
  print_notes(loaded.notes);
  print_head(loaded, request);
  std::fputs(render_table(request, result).c_str(), stdout);
  if (!faults.empty())
    std::printf("  %llu faults injected, ECC corrected %llu words\n",
                static_cast<unsigned long long>(result.faults.injected),
                static_cast<unsigned long long>(result.faults.corrected));
  if (outputs.path("--exr").empty() && outputs.path("--png").empty())
    std::puts("  no image written: name one with --exr or --png");
  require_observed(result);
  require_whole(result.is_partial, result.film, paths_of(loaded, request.options));
}

}  // namespace

void add_render_command(CLI::App& app) {
  CLI::App& command = *app.add_subcommand("render", "Render a scene with the firmware on the chip");
  const auto state = std::make_shared<RenderCommand>();
  state->options.work.samples = 16;
  state->options.program = path_tracer::default_program();
  state->scene.add_to(command);
  in_range(command.add_option("--samples", state->options.work.samples, "Paths a pixel"), 1, 1 << 30)
      ->capture_default_str();
  state->importance.add_to(command);
  state->passes.add_to(command);
  state->size.add_to(command);
  state->chip.add_to(command, "csx600");
  state->timing.add_to(command);
  state->level.add_to(command);
  command.add_flag("--native", state->native, "Run the firmware without SystemC: same image, no time");
  command.add_flag(
      "--firmware-search", state->firmware_search,
      "With --native, find hits and fill blocks as the chip does, not as the simulator is fastest");
  add_check_hazards_flag(command, state->options.check_hazards);
  state->outputs.add_to(command, "--exr", "Write the image as OpenEXR");
  state->outputs.add_to(command, "--png", "Write the image as PNG");
  state->outputs.add_to(command, "--stats,--json",
                        "Write statistics: as CSV or text to a .csv or .txt file, otherwise as JSON");
  command.add_flag("--stats-text", state->statistics_text_wanted, "Print the statistics");
  using path_tracer::OptionGroup;
  state->firmware.add_to(command, state->options.program,
                         {OptionGroup::bins, OptionGroup::sampling, OptionGroup::tree});
  state->observation.add_to(command);
  command
      .add_option(
          "--fault", state->faults,
          "Break the hardware, KIND,cycle=N,... as poly_sram,cycle=1000,pe=5,address=64,bit=3; kinds: " +
              fault_kind_names() + "; may be repeated")
      ->type_name("FAULT")
      ->allow_extra_args(false);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
