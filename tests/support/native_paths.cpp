#include "tests/support/native_paths.hpp"

#include <cstring>

#include "firmware/path_tracer/path_tracer.hpp"
#include "model/config/chip_presets.hpp"
#include "testbench/machine/native_machine.hpp"
#include "testbench/mono_image/mono_image.hpp"

namespace test_support {

using path_tracer::HostSemaphores;
using path_tracer::RadianceRecord;
using path_tracer::ResultsHeader;

testbench::RenderOptions render_options(path_tracer::Program program, int samples) {
  testbench::RenderOptions options;
  options.chip = model::preset("csx600");
  options.program.program = program;
  options.work.samples = samples;
  options.level = testbench::widest_level();
  return options;
}

std::vector<RadianceRecord> native_paths(const testbench::Scene& scene,
                                         const testbench::RenderOptions& options) {
  const testbench::MonoImage image =
      testbench::make_mono_image(scene, options.chip.chip.pes, options.program);
  testbench::NativeMachine machine(options.chip.chip.pes, options.chip.poly.sram_bytes,
                                   image.layout.total_bytes);
  std::memcpy(machine.mono(), image.bytes.data(), image.bytes.size());
  std::vector<RadianceRecord> paths;
  int half = 0;
  machine.on_signal(HostSemaphores::kResultsReady, [&] {
    const auto* header =
        reinterpret_cast<const ResultsHeader*>(machine.mono() + image.layout.results_header[half].address);
    const auto* records =
        reinterpret_cast<const RadianceRecord*>(machine.mono() + image.layout.results[half].address);
    for (int i = 0; i < header->records; ++i)
      if (records[i].pixel >= 0) paths.push_back(records[i]);
    half = 1 - half;
    machine.sem_signal(HostSemaphores::kResultsFree);
  });
  path_tracer::PathTracer tracer(machine, path_tracer::kernels(options.level), options.program, image.layout,
                                 options.work);
  tracer.run({});
  return paths;
}

}  // namespace test_support
