#include "firmware/path_tracer/traversals/search_choice.hpp"

#include <algorithm>

#include "firmware/path_tracer/traversals/ray_unit_search.hpp"
#include "firmware/path_tracer/traversals/tree_search.hpp"

namespace path_tracer {

std::unique_ptr<RaySearch> make_search(const StageContext& context, Layout& layout) {
  if (context.config.traversal == Traversal::brute_force) return std::make_unique<BruteForceSearch>(context);
  if (context.config.hands_rays_to_unit()) return std::make_unique<RayUnitSearch>(context, layout);
  return std::make_unique<TreeSearch>(context);
}

Rings make_rings(cn::Machine& machine, const ProgramConfig& config, const Layers& layers, int load_bytes,
                 int save_bytes) {
  const int tree_loads = config.walks_tree() ? TreeStage::load_bytes(config.tree, layers) : 0;
  const int tree_saves = config.walks_tree() ? TreeStage::save_bytes(config) : 0;
  const int loads = std::max({load_bytes, RayStage::kLoadBytes, tree_loads});
  const int saves = std::max({save_bytes, RayStage::save_bytes(config), tree_saves});
  return {{machine, "load buffer", {config.load_buffers(), loads, !config.buffers_loads()}},
          {machine, "save buffer", {config.save_buffers(), saves, !config.buffers_saves()}}};
}

}  // namespace path_tracer
