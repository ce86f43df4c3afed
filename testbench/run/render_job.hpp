#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "firmware/path_tracer/make_tracer.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "testbench/machine/memory_overflow.hpp"
#include "testbench/run/render.hpp"
#include "testbench/run/results.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/simulator_time.hpp"

namespace testbench {

/// What firmware and image builder refuse, as errors of the input.
template <class Work>
auto with_input_errors(Work&& work) {
  try {
    return work();
  } catch (const path_tracer::ProgramError& error) {
    throw InputError(error.what());
  } catch (const cn::PolyMemoryOverflow& error) {
    throw input_error_of(error);
  } catch (const cn::MachineFault& fault) {
    throw RunError(fault.what());
  }
}

/// Tells the caller how far the firmware is, and the firmware whether the caller wants to stop.
class ProgressRelay {
 public:
  ProgressRelay(std::uint64_t paths, const RenderProgress& progress)
      : total_(double(paths)), progress_(progress) {}

  bool operator()(std::uint64_t paths_issued) {
    if (progress_ && !progress_(double(paths_issued) / total_)) interrupted_ = true;
    return !interrupted_;
  }
  bool interrupted() const { return interrupted_; }

 private:
  double total_;
  const RenderProgress& progress_;
  bool interrupted_ = false;
};

/// The scene's image with room for the list of camera samples, if the options have one. Throws InputError
/// when mono memory has no room for it.
MonoImage image_for(const Scene& scene, const RenderOptions& options);
/// Adds the list of camera samples to an image that has none.
void add_list(MonoImage& image, const std::vector<path_tracer::CameraSampleRecord>& camera_samples);

std::uint64_t paths_of(const Scene& scene, const RenderOptions& options);

/// What both kinds of run have around the machine.
class RenderJob {
 public:
  /// @param options with which `image` was made; they live as long as the job
  RenderJob(const Scene& scene, const RenderOptions& options, MonoImage image, const RenderProgress& progress)
      : options_(options),
        image_(std::move(image)),
        relay_(paths_of(scene, options), progress),
        result_(Film(scene.film, film_scale(scene), options.film_sums)) {
    result_.textures = image_.textures;
  }

  const MonoImage& image() const { return image_; }
  RenderResult& result() { return result_; }

  /// Before anything runs on the machine. Returns the checker, or null when hazards are not to be checked.
  model::HazardChecker* check_hazards(cn::Machine& machine, model::HazardChecker::Clock clock) {
    if (!options_.check_hazards) return nullptr;
    checker_.emplace(machine, std::move(clock));
    for (const path_tracer::Layout::Region& region : image_.layout.regions)
      checker_->name_mono(region.name, {region.first, region.bytes});
    machine.set_access_observer(&*checker_);
    return &*checker_;
  }

  /// Builds the firmware on a machine and runs it to its end.
  void firmware(cn::Machine& machine) {
    const path_tracer::Kernels& kernels =
        checker_ ? path_tracer::observed_kernels() : path_tracer::kernels(options_.level);
    path_tracer::Work work = options_.work;
    work.listed_samples = image_.camera_samples.size();
    const std::unique_ptr<path_tracer::Tracer> tracer =
        path_tracer::make_tracer(machine, kernels, options_.program, image_.layout, work);
    tracer->run(std::ref(relay_));
    result_.counts = tracer->counts();
    if (checker_) checker_->firmware_ends();
  }

  RenderResult finish() {
    if (checker_) checker_->throw_if_found();
    result_.cpu_seconds = timer_.cpu_seconds();
    result_.wall_seconds = timer_.wall_seconds();
    result_.is_partial = relay_.interrupted();
    require_no_rejected_samples(result_.film);
    return std::move(result_);
  }

 private:
  const RenderOptions& options_;
  MonoImage image_;
  ProgressRelay relay_;
  RenderResult result_;
  std::optional<model::HazardChecker> checker_;
  SimulatorTimer timer_;
};

}  // namespace testbench
