#include "testbench/run/render.hpp"

#include <algorithm>
#include <cstring>
#include <memory>

#include "firmware/path_tracer/path_tracer.hpp"
#include "model/config/address_map.hpp"
#include "model/hazards/hazard_checker.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/machine/recording_machine.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/observe/observation.hpp"
#include "testbench/run/host_pc.hpp"
#include "testbench/run/results.hpp"
#include "testbench/system/error.hpp"
#include "testbench/system/simulator_time.hpp"

namespace testbench {
namespace {

/// What firmware and image builder refuse, as errors of the input.
template <class Work>
auto with_input_errors(Work&& work) {
  try {
    return work();
  } catch (const path_tracer::ProgramError& error) {
    throw InputError(error.what());
  } catch (const cn::PolyMemoryOverflow& error) {
    const std::string map = error.map().substr(0, error.map().find_last_not_of('\n') + 1);
    throw InputError(std::string(error.what()) + "; buffers of a PE:", map);
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

/// @param what needs the memory: "scene and bins need "
void require_mono_memory(const std::string& what, std::uint64_t bytes, const model::ChipConfig& chip) {
  if (bytes <= chip.ddr.size_bytes) return;
  throw InputError(what + std::to_string(bytes) + " bytes of mono memory, ddr.size_bytes allows " +
                   std::to_string(chip.ddr.size_bytes));
}

/// Building the image of ten million triangles takes a minute: a chip whose memory cannot hold even their
/// records is refused before.
void require_memory_for_triangles(const Scene& scene, const RenderOptions& options) {
  const int slots = options.program.uses_tree() ? options.program.tree.resident_nodes : 0;
  const path_tracer::SceneCounts least{static_cast<int>(scene.triangles.size()), 1, slots,
                                       scene.coincident_triangles > 0};
  const path_tracer::Layout layout = path_tracer::make_layout(least, options.chip.chip.pes, options.program);
  require_mono_memory("scene and bins need at least ", layout.total_bytes, options.chip);
}

MonoImage make_checked_image(const Scene& scene, const RenderOptions& options) {
  path_tracer::validate(options.program);
  require_memory_for_triangles(scene, options);
  return make_normal_mono_image(scene, options.chip.chip.pes, options.program, options.light_survey.get());
}

std::uint64_t paths_of(const Scene& scene, const RenderOptions& options) {
  if (!options.camera_samples.empty()) return options.camera_samples.size();
  return std::uint64_t(scene.film.width) * std::uint64_t(scene.film.height) *
         std::uint64_t(options.work.samples);
}

/// What both kinds of run have around the machine.
class Run {
 public:
  Run(const Scene& scene, const RenderOptions& options, const RenderProgress& progress)
      : options_(options),
        image_(checked_image(scene, options)),
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
    path_tracer::PathTracer tracer(machine, kernels, options_.program, image_.layout, work);
    tracer.run(std::ref(relay_));
    result_.counts = tracer.counts();
    if (checker_ && !relay_.interrupted()) checker_->firmware_ends();
  }

  RenderResult finish() {
    if (checker_) checker_->throw_if_found();
    result_.cpu_seconds = timer_.cpu_seconds();
    result_.wall_seconds = timer_.wall_seconds();
    if (relay_.interrupted()) throw RunError("interrupted; nothing was written");
    require_no_rejected_samples(result_.film);
    return std::move(result_);
  }

 private:
  static MonoImage checked_image(const Scene& scene, const RenderOptions& options) {
    MonoImage image = options.image ? *options.image : make_checked_image(scene, options);
    image.camera_samples = options.camera_samples;
    if (!image.camera_samples.empty())
      path_tracer::add_camera_samples(image.layout, image.camera_samples.size());
    require_mono_memory(image, options.chip);
    return image;
  }

  const RenderOptions& options_;
  MonoImage image_;
  ProgressRelay relay_;
  RenderResult result_;
  std::optional<model::HazardChecker> checker_;
  SimulatorTimer timer_;
};

/// A machine without a clock; a recording one where a stream is wanted.
std::unique_ptr<NativeMachine> native_machine(const model::ChipConfig& chip, std::uint64_t mono_bytes,
                                              TimingStream* record) {
  const cn::MonoRange scratchpad = model::on_chip_sram_range(chip);
  if (record == nullptr)
    return std::make_unique<NativeMachine>(chip.chip.pes, chip.poly.sram_bytes, mono_bytes, scratchpad);
  return std::make_unique<RecordingMachine>(chip.chip.pes, chip.poly.sram_bytes, mono_bytes, *record,
                                            scratchpad);
}

void copy_to(NativeMachine& machine, const MonoImage& image) {
  std::memcpy(machine.mono(), image.bytes.data(), image.bytes.size());
  if (!image.camera_samples.empty())
    std::memcpy(machine.mono() + image.layout.camera_samples.address, image.camera_samples.data(),
                image.camera_sample_bytes());
}

}  // namespace

std::shared_ptr<const MonoImage> make_image(const Scene& scene, const RenderOptions& options) {
  return with_input_errors(
      [&] { return std::make_shared<const MonoImage>(make_checked_image(scene, options)); });
}

void require_list_memory(std::uint64_t samples, const model::ChipConfig& chip) {
  require_mono_memory("the list of " + std::to_string(samples) + " paths needs ",
                      samples * sizeof(path_tracer::CameraSampleRecord), chip);
}

void require_mono_memory(const MonoImage& image, const model::ChipConfig& chip) {
  require_mono_memory("scene and bins need ", image.layout.total_bytes, chip);
}

RenderResult render_on_chip(const Scene& scene, const RenderOptions& options,
                            const RenderProgress& progress) {
  return with_input_errors([&] {
    Run run(scene, options, progress);
    model::Csx600 chip("csx600", options.chip, options.timing);
    HostPc host("host", chip, run.image(), run.result().film);
    host.report_reads_to(run.check_hazards(chip.control_unit, [&] { return chip.control_unit.now(); }));
    Observation observation(options.observation, chip);
    chip.control_unit.load([&](cn::Machine& machine) { run.firmware(machine); });
    sc_core::sc_start();
    chip.control_unit.require_finished();
    if (!host.finished()) throw RunError("the firmware has ended, but the host has not");
    run.result().chip = collect_statistics(chip, host.finished_cycle());
    RenderResult result = run.finish();
    result.observation_failures = observation.finish();
    return result;
  });
}

void search_natively(RenderOptions& options) {
  options.searches_natively = true;
  options.program.traversal = path_tracer::Traversal::brute_force;
}

namespace {

/// One of the chips of a board, with its share of the samples.
class BoardChip {
 public:
  BoardChip(const std::string& name, const Scene& scene, const RenderOptions& share)
      : options_(share),
        run_(scene, options_, no_progress_),
        chip_(name.c_str(), options_.chip, options_.timing),
        host_((name + "_host").c_str(), chip_, run_.image(), run_.result().film) {
    host_.report_reads_to(
        run_.check_hazards(chip_.control_unit, [this] { return chip_.control_unit.now(); }));
    chip_.control_unit.load([this](cn::Machine& machine) { run_.firmware(machine); });
  }
  model::Csx600& chip() { return chip_; }

  RenderResult finish() {
    chip_.control_unit.require_finished();
    if (!host_.finished()) throw RunError("the firmware has ended, but the host has not");
    run_.result().chip = collect_statistics(chip_, host_.finished_cycle());
    return run_.finish();
  }

 private:
  RenderOptions options_;
  RenderProgress no_progress_;
  Run run_;
  model::Csx600 chip_;
  HostPc host_;
};

RenderOptions share_of(const RenderOptions& options, int chip, int chips) {
  const auto first_of = [&](int i) { return int(std::int64_t(options.work.samples) * i / chips); };
  RenderOptions share = options;
  share.work.first_sample += first_of(chip);
  share.work.samples = first_of(chip + 1) - first_of(chip);
  return share;
}

void check_board(const RenderOptions& options, int chips) {
  if (chips < 1) throw InputError("board: found " + std::to_string(chips) + " chips; allowed: 1 or more");
  if (!options.camera_samples.empty())
    throw InputError("board: found a list of samples; allowed: the same number for every pixel");
  if (options.work.samples < chips)
    throw InputError("board: found " + std::to_string(options.work.samples) + " samples a pixel for " +
                     std::to_string(chips) + " chips; allowed: at least one a chip");
}

}  // namespace

BoardRender render_on_board(const Scene& scene, const RenderOptions& options, int chips) {
  check_board(options, chips);
  return with_input_errors([&] {
    std::vector<std::unique_ptr<BoardChip>> board;
    for (int i = 0; i < chips; ++i) {
      board.push_back(
          std::make_unique<BoardChip>("csx600_" + std::to_string(i), scene, share_of(options, i, chips)));
      board.back()->chip().host_link.share_link_of(board.front()->chip().host_link);
    }
    sc_core::sc_start();
    BoardRender render{Film(scene.film, film_scale(scene), options.film_sums), 0, 0, {}};
    model::Cycles start = board.front()->chip().control_unit.start_cycle();
    model::Cycles end = 0;
    for (const auto& one : board) {
      const RenderResult result = one->finish();
      render.film.merge(result.film);
      render.segments += result.counts.segments;
      render.chips.push_back(*result.chip);
      start = std::min(start, one->chip().control_unit.start_cycle());
      end = std::max(end, one->chip().control_unit.now());
    }
    render.firmware_cycles = end - start;
    return render;
  });
}

RenderResult render_natively(const Scene& scene, const RenderOptions& options, const RenderProgress& progress,
                             TimingStream* record) {
  return with_input_errors([&] {
    Run run(scene, options, progress);
    const path_tracer::Layout& layout = run.image().layout;
    const std::unique_ptr<NativeMachine> owned = native_machine(options.chip, layout.total_bytes, record);
    NativeMachine& machine = *owned;
    copy_to(machine, run.image());
    if (options.searches_natively && record == nullptr && !options.check_hazards) machine.stop_counting();
    ResultReader results(layout, run.result().film);
    model::HazardChecker* const checker = run.check_hazards(machine, {});
    machine.on_signal(path_tracer::HostSemaphores::kResultsReady, [&] {
      results.fetch([&](cn::MonoAddress from, void* to, std::size_t bytes) {
        if (checker != nullptr) checker->host_touches_mono(cn::Access::read, {from, bytes});
        std::memcpy(to, machine.mono() + from, bytes);
      });
      machine.sem_signal(path_tracer::HostSemaphores::kResultsFree);
    });
    run.firmware(machine);
    if (auto* const recording = dynamic_cast<RecordingMachine*>(&machine)) recording->finish();
    return run.finish();
  });
}

void require_observed(const RenderResult& result) {
  if (!result.observation_failures.empty()) throw RunError(result.observation_failures);
}

}  // namespace testbench
