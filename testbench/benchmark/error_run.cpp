#include "testbench/benchmark/error_run.hpp"

#include <algorithm>

#include "testbench/film/light_pixels.hpp"
#include "testbench/mono_image/scene_features.hpp"
#include "testbench/run/render_parts.hpp"
#include "testbench/system/error.hpp"

namespace testbench {
namespace {

/// 1, 1, 2, 4, ... samples: after part k there are 2^k.
std::vector<path_tracer::Work> doubling_parts(int samples) {
  std::vector<path_tracer::Work> parts{{0, 1}};
  for (int done = 1; done < samples; done *= 2) parts.push_back({done, done});
  return parts;
}

std::vector<bool> pixels_that_count(const Scene& scene) {
  std::vector<bool> counts = light_pixels(scene);
  counts.flip();
  if (std::find(counts.begin(), counts.end(), true) == counts.end())
    throw InputError(scene.name + ": found the light in every pixel; allowed: at least one pixel without it");
  return counts;
}

/// A film and what it took so far.
class GrowingRender {
 public:
  GrowingRender(const Scene& scene, const RenderOptions& options, MachineKind machine)
      : scene_(scene),
        options_(options),
        machine_(machine),
        film_(scene.film, film_scale(scene), options.film_sums) {}

  void add(const path_tracer::Work& work) {
    if (!options_.image) options_.image = make_image(scene_, options_);
    const PartialRender part = render_parts(scene_, options_, machine_, {work}).front();
    film_.merge(part.film);
    cpu_seconds_ += part.cpu_seconds;
    simulated_seconds_ += part.simulated_seconds.value_or(0);
    joules_ += part.joules.value_or(0);
  }

  const Film& film() const { return film_; }
  double cpu_seconds() const { return cpu_seconds_; }
  double simulated_seconds() const { return simulated_seconds_; }
  double joules() const { return joules_; }

 private:
  const Scene& scene_;
  RenderOptions options_;
  MachineKind machine_;
  Film film_;
  double cpu_seconds_ = 0;
  double simulated_seconds_ = 0;
  double joules_ = 0;
};

}  // namespace

std::vector<const path_tracer::ProgramOption*> options_of_curves() {
  std::vector<const path_tracer::ProgramOption*> options{path_tracer::find_option("n")};
  for (const path_tracer::ProgramOption& option : path_tracer::program_options())
    if (option.group == path_tracer::OptionGroup::sampling) options.push_back(&option);
  return options;
}

path_tracer::ProgramConfig program_for(const Scene& scene, const model::ChipConfig& chip,
                                       const path_tracer::ProgramConfig& program, const GivenOptions& given) {
  path_tracer::ProgramConfig fitted = program;
  if (given.count("light_candidates") == 0) fitted.light_candidates = suited_light_candidates(scene, program);
  if (given.count("estimator") == 0) fitted.estimator = suited_estimator(scene, fitted.light_candidates);
  fitted = built_for(scene, fitted);
  choose_tree(TriangleCount(scene), chip, given, fitted);
  return fitted;
}

std::vector<CurvePoint> measure_error(const Scene& scene, const ExrFilm& reference,
                                      const RenderOptions& options, const CurveSamples& samples,
                                      const std::function<void(double share)>& progress) {
  const std::vector<bool> counts = pixels_that_count(scene);
  RenderOptions native_options = options;
  search_natively(native_options);
  GrowingRender native(scene, native_options, MachineKind::native);
  GrowingRender timed(scene, options, MachineKind::chip);
  std::vector<CurvePoint> points;
  for (const path_tracer::Work& work : doubling_parts(samples.native)) {
    CurvePoint point;
    point.samples = work.first_sample + work.samples;
    native.add(work);
    point.native_cpu_seconds = native.cpu_seconds();
    if (point.samples <= samples.timed) {
      timed.add(work);
      if (timed.film().sha256() != native.film().sha256())
        throw RunError("the image of the chip differs from the native one after " +
                       std::to_string(point.samples) + " samples");
      point.timed_cpu_seconds = timed.cpu_seconds();
      point.simulated_seconds = timed.simulated_seconds();
      point.joules = timed.joules();
    }
    point.error = image_error(native.film(), reference, counts);
    points.push_back(point);
    progress(double(point.samples) / samples.native);
  }
  return points;
}

}  // namespace testbench
