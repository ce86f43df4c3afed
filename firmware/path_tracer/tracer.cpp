#include "firmware/path_tracer/tracer.hpp"

#include <algorithm>

#include "firmware/path_tracer/bidirectional/bidirectional_tracer.hpp"
#include "firmware/path_tracer/path_tracer.hpp"
#include "firmware/path_tracer/traversals/tree_search.hpp"

namespace path_tracer {
namespace {

/// Where unoptimised Cn keeps its locals; the stack lies at the low end of poly SRAM (SDK Reference
/// Manual 3.1, p. 163).
constexpr int kStackBytes = 1024;

}  // namespace

std::unique_ptr<Tracer> make_tracer(cn::Machine& machine, const Kernels& kernels, const ProgramConfig& config,
                                    const Layout& layout, const Work& work) {
  if (config.is_bidirectional())
    return std::make_unique<BidirectionalTracer>(machine, kernels, config, layout, work);
  return std::make_unique<PathTracer>(machine, kernels, config, layout, work);
}

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

Rings make_rings(cn::Machine& machine, const ProgramConfig& config, const Layers& layers, int load_bytes,
                 int save_bytes) {
  const int of_search = config.uses_tree() ? TreeStage::load_bytes(config.tree, layers) : 0;
  const int hits = config.uses_tree() ? TreeStage::save_bytes(config) : 0;
  const int loads = std::max({load_bytes, RayStage::kLoadBytes, of_search});
  const int saves = std::max({save_bytes, RayStage::save_bytes(config), hits});
  return {{machine, "load buffer", {config.load_buffers(), loads, !config.buffers_loads()}},
          {machine, "save buffer", {config.save_buffers(), saves, !config.buffers_saves()}}};
}

std::unique_ptr<RaySearch> make_search(const StageContext& context) {
  if (context.config.traversal == Traversal::brute_force) return std::make_unique<BruteForceSearch>(context);
  return std::make_unique<TreeSearch>(context);
}

}  // namespace path_tracer
