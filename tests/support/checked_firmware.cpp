#include "tests/support/checked_firmware.hpp"

#include <cstring>

#include "testbench/film/film.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/run/results.hpp"
#include "tests/support/broken_machine.hpp"
#include "tests/support/hazards.hpp"
#include "tests/support/scenes.hpp"

namespace test_support {

using path_tracer::HostSemaphores;

CheckedProgram::CheckedProgram(const testbench::Scene& scene, const path_tracer::ProgramConfig& config,
                               int num_pes)
    : scene_(scene),
      config_(config),
      num_pes_(num_pes),
      image_(testbench::make_mono_image(scene, num_pes, config)) {}

CheckedRun CheckedProgram::run(int samples, const Mutation& mutation) const {
  testbench::MonoImage image = image_;
  mutation.layout(image.layout);
  constexpr int kPolyBytes = 32768;  // eight buffers of one stage need more than the CSX600's 6 KiB
  BrokenMachine machine(num_pes_, kPolyBytes, image.layout.total_bytes, mutation.dropped_wait);
  machine.set_last_host_semaphore(HostSemaphores::kResultsFree);
  std::memcpy(machine.mono(), image.bytes.data(), image.bytes.size());

  model::HazardChecker checker(machine);
  for (const path_tracer::Layout::Region& region : image.layout.regions)
    checker.name_mono(region.name, {region.first, region.bytes});
  machine.set_access_observer(&checker);

  testbench::Film film(scene_.film, testbench::film_scale(scene_));
  testbench::ResultReader results(image.layout, film);
  machine.on_signal(HostSemaphores::kResultsReady, [&] {
    results.fetch([&](cn::MonoAddress from, void* to, std::size_t bytes) {
      checker.host_touches_mono(cn::Access::read, {from, bytes});
      std::memcpy(to, machine.mono() + from, bytes);
    });
    machine.sem_signal(HostSemaphores::kResultsFree);
  });
  CheckedRun run;
  run.fault = fault_of([&] {
    path_tracer::PathTracer tracer(machine, path_tracer::observed_kernels(), config_, image.layout,
                                   {0, samples});
    tracer.run({});
    checker.firmware_ends();
  });
  run.waits = machine.needed_waits();
  run.requests = checker.requests();
  return run;
}

CheckedRun run_checked(const testbench::Scene& scene, const path_tracer::ProgramConfig& config, int num_pes,
                       int samples, const Mutation& mutation) {
  return CheckedProgram(scene, config, num_pes).run(samples, mutation);
}

testbench::Scene small_scene() {
  return closed_cube(0.8, 1.0, {6, 4});
}

testbench::Scene open_scene() {
  return triangle_soup(20, 3, {9, 7});
}

}  // namespace test_support
