#include <algorithm>
#include <cstdio>
#include <memory>

#include "testbench/benchmark/error_run.hpp"
#include "testbench/commands/bench/bench_command.hpp"
#include "testbench/commands/command_options.hpp"
#include "testbench/commands/firmware_options.hpp"
#include "testbench/commands/named_values.hpp"
#include "testbench/commands/output_files.hpp"
#include "testbench/film/image_agreement.hpp"
#include "testbench/film/image_file.hpp"
#include "testbench/run/render_parts.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "testbench/statistics/render_report.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/progress_bar.hpp"

namespace testbench {
namespace {

/// What one process renders at a time: long enough to be worth a process, short enough to show progress.
constexpr int kSamplesOfPart = 64;

/// How a second image of the scene is rendered.
struct SecondEstimator {
  RenderOptions options;
  std::string how;  ///< what its paths do
};

struct BenchReferenceCommand {
  SceneArgument scene;
  SizeOption size;
  OutputFiles outputs;
  RenderOptions options;
  ChipOptions chip;
  LevelOption level;
  FirmwareOptions firmware;
  int jobs = 1;
  int check_samples = 0;  ///< 0: no check

  void run();

 private:
  RenderResult render(const Scene& loaded, const RenderOptions& of, const char* what) const;
  SecondEstimator second_estimator(const Scene& loaded) const;
  void check(const Scene& loaded, const Film& reference) const;
};

RenderResult BenchReferenceCommand::render(const Scene& loaded, const RenderOptions& of,
                                           const char* what) const {
  RenderResult result{Film(loaded.film, film_scale(loaded))};
  const std::vector<path_tracer::Work> parts = split_work(of.work, kSamplesOfPart);
  ProgressBar bar(what);
  for (std::size_t next = 0; next < parts.size();) {
    const std::size_t last = std::min(parts.size(), next + std::size_t(jobs));
    const auto begin = parts.begin();
    for (const PartialRender& part : render_parts(
             loaded, of, MachineKind::native, {begin + std::ptrdiff_t(next), begin + std::ptrdiff_t(last)})) {
      result.film.merge(part.film);
      result.counts.segments += part.segments;
      result.cpu_seconds += part.cpu_seconds;
    }
    next = last;
    bar.show(double(next) / double(parts.size()));
  }
  return result;
}

/// Light found by hits only, by other random numbers, on paths from the lens alone. No hit finds a light
/// without area. Scenes with such lights have shadow rays in both images, but others choose and weigh them.
SecondEstimator BenchReferenceCommand::second_estimator(const Scene& loaded) const {
  RenderOptions second = options;
  second.program.seed = options.program.seed + 1;
  second.work.samples = check_samples;
  second.program.paths = path_tracer::Paths::unidirectional;
  if (loaded.lights.empty()) {
    second.program.program = path_tracer::Program::segments;
    return {second, "find light by hits only"};
  }
  using path_tracer::Estimator;
  second.program.estimator = options.program.estimator == Estimator::mis ? Estimator::light : Estimator::mis;
  second.program.light_sampling = path_tracer::LightSampling::solid_angle;
  second.program.light_candidates =
      options.program.light_candidates > 1 ? 1 : path_tracer::kMaxLightCandidates;
  return {second, "choose lights among " + std::to_string(second.program.light_candidates) +
                      ", by estimator " + name_of(second.program.estimator)};
}

void BenchReferenceCommand::check(const Scene& loaded, const Film& reference) const {
  if (check_samples == 0) return;
  const SecondEstimator estimator = second_estimator(loaded);
  const RenderResult second = render(loaded, estimator.options, "bench reference: second estimator");
  const ImageAgreement agreement = agreement_of(reference, second.film);
  std::printf("against %d samples a pixel that %s:\n%s", check_samples, estimator.how.c_str(),
              agreement.text().c_str());
  if (!agreement.holds())
    throw RunError(loaded.name + ": the two estimators give different images; nothing was written");
}

void BenchReferenceCommand::run() {
  outputs.require_writable();
  size.require_valid();
  options.chip = chip.chip();
  options.level = level.level();
  const Scene loaded = size.resized(scene.load());
  outputs.require_no_input(inputs_of(chip, loaded));
  options.program = program_for(loaded, options.chip, options.program);
  search_natively(options);
  const RenderResult result = render(loaded, options, "bench reference");
  check(loaded, result.film);
  std::map<std::string, std::string> attributes = render_provenance({scene.path(), options, true}, result);
  attributes[kSeedAttribute] = std::to_string(options.program.seed);
  const std::string& exr = outputs.path("--output");
  write_exr(exr, result.film, attributes);
  print_notes(loaded.notes);
  std::printf("%s, %d x %d, %d samples a pixel, seed %llu: %s, %.1f s CPU\n", loaded.name.c_str(),
              loaded.film.width, loaded.film.height, options.work.samples,
              static_cast<unsigned long long>(options.program.seed), exr.c_str(), result.cpu_seconds);
}

}  // namespace

void add_bench_reference_command(CLI::App& bench) {
  CLI::App& command = *bench.add_subcommand(
      "reference", "Render the image that errors are measured against: independent samples, many of them");
  const auto state = std::make_shared<BenchReferenceCommand>();
  state->options.work.samples = 16384;
  state->options.program = path_tracer::default_program();
  // Independent samples, so that the variance layers are the error; light sampled otherwise than by default,
  // so that a bias of either shows.
  state->options.program.sampler = path_tracer::Sampler::philox;
  state->options.program.light_sampling = path_tracer::LightSampling::area;
  state->options.program.seed = kReferenceSeed;
  state->scene.add_to(command);
  state->outputs.add_to(command, "-o,--output", "OpenEXR file to write").required();
  in_range(command.add_option("--samples", state->options.work.samples, "Paths a pixel"), 2, 1 << 30)
      ->capture_default_str();
  in_range(command.add_option(
               "--check-samples", state->check_samples,
               "Paths a pixel of a second image, whose paths find light by hits only, or weigh both "
               "ways otherwise where lights have no area; if the two differ by more than their noise, the "
               "command fails"),
           2, 1 << 30)
      ->default_str("none");
  state->size.add_to(command);
  for (const char* const option : {"paths", "light_vertices", "seed"})
    state->firmware.add_to(command, state->options.program, *path_tracer::find_option(option));
  add_jobs_option(command, state->jobs);
  state->chip.add_to(command, "csx600");
  state->level.add_to(command);
  command.callback([state] { state->run(); });
}

}  // namespace testbench
