#include "testbench/run/render.hpp"

#include <cstring>
#include <memory>

#include "model/config/address_map.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/machine/recording_machine.hpp"
#include "testbench/run/render_job.hpp"

namespace testbench {
namespace {

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

/// A machine without a clock; a recording one where a stream is wanted.
std::unique_ptr<NativeMachine> native_machine(const model::ChipConfig& chip, std::uint64_t mono_bytes,
                                              TimingStream* record) {
  const cn::MonoRange scratchpad = model::on_chip_sram_range(chip);
  if (record == nullptr)
    return std::make_unique<NativeMachine>(chip.chip.pes, chip.poly.sram_bytes, mono_bytes, scratchpad,
                                           model::search_unit_range(chip));
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

std::uint64_t paths_of(const Scene& scene, const RenderOptions& options) {
  if (!options.camera_samples.empty()) return options.camera_samples.size();
  return std::uint64_t(scene.film.width) * std::uint64_t(scene.film.height) *
         std::uint64_t(options.work.samples);
}

void add_list(MonoImage& image, const std::vector<path_tracer::CameraSampleRecord>& camera_samples) {
  image.camera_samples = camera_samples;
  if (!camera_samples.empty()) path_tracer::add_camera_samples(image.layout, camera_samples.size());
}

MonoImage image_for(const Scene& scene, const RenderOptions& options) {
  MonoImage image = options.image ? *options.image : make_checked_image(scene, options);
  add_list(image, options.camera_samples);
  require_mono_memory(image, options.chip);
  return image;
}

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

void search_natively(RenderOptions& options) {
  options.searches_natively = true;
  options.program.traversal = path_tracer::Traversal::brute_force;
}

RenderResult render_natively(const Scene& scene, const RenderOptions& options, const RenderProgress& progress,
                             TimingStream* record) {
  return with_input_errors([&] {
    RenderJob run(scene, options, image_for(scene, options), progress);
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
