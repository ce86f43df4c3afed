#include "firmware/path_tracer/pipeline/tracer.hpp"

#include "firmware/path_tracer/pipeline/results_handover.hpp"

namespace path_tracer {
namespace {

/// Where unoptimised Cn keeps its locals; the stack lies at the low end of poly SRAM (SDK Reference
/// Manual 3.1, p. 163).
constexpr int kStackBytes = 1024;

}  // namespace

ProgramConfig built_for(const Layout& layout, ProgramConfig config) {
  validate(config);
  config.features = layout.features;
  return config;
}

cn::Machine& with_semaphores_and_stack(cn::Machine& machine) {
  HostSemaphores::allocate(machine);
  machine.poly_memory().allocate("stack", kStackBytes);
  return machine;
}

}  // namespace path_tracer
