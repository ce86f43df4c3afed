#include "firmware/path_tracer/program/layout.hpp"

#include <algorithm>

namespace path_tracer {

int traversal_bin_blocks(const ProgramConfig& config) {
  return config.bin_blocks + 2 * config.load_buffers() + config.save_buffers();
}

int record_steps(const ProgramConfig& config) {
  return 2 * config.load_buffers() - 1;
}

namespace {

/// Hands out mono memory upwards from an address, in whole DDR packets.
class MonoAllocator {
 public:
  explicit MonoAllocator(std::vector<Layout::Region>& regions, std::uint64_t next = 0)
      : regions_(regions), next_(next) {}

  /// @param record_bytes of a record, with its tail
  template <class T>
  cn::MonoPointer<T> take(const char* name, std::uint64_t count, int record_bytes = sizeof(T)) {
    const cn::MonoPointer<T> start{next_};
    const std::uint64_t bytes = count * std::uint64_t(record_bytes);
    regions_.push_back({name, next_, bytes});
    next_ = (next_ + bytes + kAlignment - 1) / kAlignment * kAlignment;
    return start;
  }
  std::uint64_t used_bytes() const { return next_; }

 private:
  static constexpr std::uint64_t kAlignment = 64;
  std::vector<Layout::Region>& regions_;
  std::uint64_t next_;
};

/// Blocks of the treelet queues' pool: enough for all rays, packed, and a few more for partly full blocks of
/// treelets. If every treelet has a block, blocks are processed nearly empty. With 128 more blocks, a bin of
/// 8 blocks took 3283 cycles a ray in a scene of 1000 triangles and 7180 in one of 100,000; with 8 more, 1871
/// and 3210; a bin of 128 blocks took 1732 and 2920. Blocks of rays that end become free for treelets.
int treelet_pool_blocks(const SceneCounts& scene, int num_pes, const ProgramConfig& config) {
  constexpr std::int64_t kMostGroups = 8;
  const TreeShape& tree = config.tree;
  const std::int64_t treelets = (scene.tree_slots - tree.resident_nodes) / tree.treelet_nodes;
  const std::int64_t rays = std::int64_t(num_pes) * config.bin_blocks;
  const auto groups = static_cast<int>(std::min({treelets, rays, kMostGroups}));
  return config.bin_blocks + 1 + record_steps(config) + groups;
}

void take_treelet_pool(Layout& layout, MonoAllocator& memory, int num_pes, const ProgramConfig& config) {
  layout.treelet_pool = memory.take<std::uint64_t>(
      "treelet queues", std::uint64_t(num_pes) * std::uint64_t(layout.treelet_pool_blocks) *
                            std::uint64_t(config.tree.record_bytes()) / 8);
}

std::uint64_t slots_of(int num_pes, const ProgramConfig& config) {
  return std::uint64_t(num_pes) * std::uint64_t(config.bin_blocks);
}

/// Bins of scattered paths, of the light that their shadow rays find, and of paths.
void take_path_bins(Layout& layout, MonoAllocator& memory, std::uint64_t slots, const ProgramConfig& config) {
  layout.scatter_bin = memory.take<ScatterRecord>("scatter bin", slots, layout.sizes.scatter);
  layout.lighting_bin = memory.take<LightingRecord>("lighting bin", slots, layout.sizes.lighting);
  layout.direct_light_bin = memory.take<DirectLightRecord>("direct light bin", slots);
  layout.path_bin = memory.take<PathRecord>("path bin", slots, layout.sizes.path);
  if (config.bins_hits()) {
    layout.binned_hits =
        memory.take<BinnedHit>("binned hits", slots * std::uint64_t(hit_kinds(config.features)));
    layout.casts_bin = memory.take<cn::MonoAddress>("casts bin", slots);
  }
  if (config.is_stream()) {
    layout.slot_states = memory.take<SlotState>("slot states", slots);
    layout.finished_bin = memory.take<FinishedRecord>("finished bin", slots);
    layout.path_numbers =
        memory.take<std::uint64_t>("path numbers", ScanLevels(std::int32_t(slots)).all_words);
  }
  layout.vertices = memory.take<VertexRecord>("vertices", slots * std::uint64_t(config.slot_vertices));
  layout.folds = memory.take<FoldRecord>("folds", slots);
  layout.finished = memory.take<FinishedRecord>("finished paths", slots);
}

/// The path bin of bidirectional paths: a pair of paths in each slot.
void take_pair_bins(Layout& layout, MonoAllocator& memory, std::uint64_t slots, const ProgramConfig& config) {
  const PairSizes sizes(config.features, config.light_vertices);
  layout.pair_bin = memory.take<PairRecord>("pair bin", slots, sizes.pair);
  layout.path_vertices = memory.take<PathVertexRecord>(
      "path vertices", slots * std::uint64_t(config.light_vertices + 1), sizes.vertex);
  layout.light_heads =
      memory.take<LightHeadRecord>("light heads", slots * std::uint64_t(config.light_vertices));
}

/// Takes what paths need on their way round the circular buffer.
void take_bins(Layout& layout, MonoAllocator& memory, const SceneCounts& scene, int num_pes,
               const ProgramConfig& config) {
  const std::uint64_t slots = slots_of(num_pes, config);
  const TreeShape& tree = config.tree;
  if (config.walks_tree()) {
    layout.ray_queue = memory.take<QueuedRay>("ray queue", slots);
  } else if (!config.uses_tree()) {
    layout.ray_bin = memory.take<RayRecord>("ray bin", slots);
  }
  if (config.traversal == Traversal::temporary_bin)
    layout.traversal_bin = memory.take<std::uint64_t>(
        "traversal bin", std::uint64_t(num_pes) * std::uint64_t(traversal_bin_blocks(config)) *
                             std::uint64_t(tree.record_bytes()) / 8);
  if (config.traversal == Traversal::shared_treelets) {
    layout.treelet_pool_blocks = treelet_pool_blocks(scene, num_pes, config);
    take_treelet_pool(layout, memory, num_pes, config);
  }
  if (!config.hands_rays_to_unit())
    layout.intersection_bin = memory.take<HitRecord>("intersection bin", slots, layout.sizes.hit);
  if (config.walks_tree())
    layout.surface_place_bin = memory.take<cn::MonoAddress>("surface place bin", slots);
  if (config.is_bidirectional())
    take_pair_bins(layout, memory, slots, config);
  else
    take_path_bins(layout, memory, slots, config);
}

}  // namespace

Layout make_layout(const SceneCounts& scene, int num_pes, const ProgramConfig& config) {
  const TreeShape& tree = config.tree;
  Layout layout;
  MonoAllocator memory(layout.regions);
  layout.features = config.features;
  layout.sizes = RecordSizes(config.features);
  layout.triangle_count = scene.triangles;
  layout.light_count = scene.lights;
  layout.light_class_count = scene.light_classes;
  layout.tree_slots = scene.tree_slots;
  layout.camera = memory.take<CameraRecord>("camera", 1);
  // All leaf loads have the same size, so the last leaf's load reaches beyond the last triangle.
  const int behind_triangles = config.uses_tree() ? kLightRun * scene.lights + tree.leaf_records() : 0;
  const auto triangles = std::uint64_t(scene.triangles + behind_triangles);
  layout.layers.any = scene.has_layers;
  layout.triangles =
      scene.has_layers
          ? cn::MonoPointer<TriangleRecord>{memory.take<LayeredTriangleRecord>("triangles", triangles)
                                                .address}
          : memory.take<TriangleRecord>("triangles", triangles);
  layout.surfaces =
      memory.take<SurfaceRecord>("surfaces", std::uint64_t(scene.triangles), layout.sizes.surface);
  layout.lights = memory.take<LightRecord>("lights", std::uint64_t(scene.lights));
  const int cdf_entries = scene.light_classes > 0 ? scene.light_classes : scene.lights;
  layout.light_cdf = memory.take<double>("light cdf", std::uint64_t(cdf_entries));
  if (scene.light_classes > 0)
    layout.light_classes = memory.take<LightClass>("light classes", std::uint64_t(scene.light_classes));
  if (config.resamples_lights())
    layout.light_candidates = memory.take<LightCandidate>("light candidates", std::uint64_t(scene.lights));
  if (config.is_bidirectional())
    layout.light_emission = memory.take<LightEmissionRecord>("light emission", std::uint64_t(scene.lights));
  if (config.uses_tree())
    layout.nodes = memory.take<std::uint64_t>(
        "nodes", std::uint64_t(scene.tree_slots) * std::uint64_t(tree.layout.node_bytes()) / 8);
  if (scene.texture_bytes > 0)
    layout.textures = memory.take<std::uint64_t>("textures", (scene.texture_bytes + 7) / 8);
  if (scene.environment_texels > 0)
    layout.environment_image.texels =
        memory.take<EnvironmentTexel>("environment", scene.environment_texels).address;
  layout.sun_count = scene.suns;
  if (scene.suns > 0) layout.suns = memory.take<SunRecord>("suns", std::uint64_t(scene.suns));
  if (scene.suns > 0 && config.is_bidirectional())
    layout.sun_pdfs = memory.take<double>("densities of suns", std::uint64_t(scene.suns));
  layout.scene_bytes = memory.used_bytes();
  if (!config.keeps_paths_in_sram()) take_bins(layout, memory, scene, num_pes, config);
  const std::uint64_t results = config.keeps_paths_in_sram()
                                    ? std::uint64_t(num_pes) * std::uint64_t(kResidentResults)
                                    : slots_of(num_pes, config);
  for (auto& header : layout.results_header) header = memory.take<ResultsHeader>("results header", 1);
  for (auto& half : layout.results) half = memory.take<RadianceRecord>("results", results);
  layout.total_bytes = memory.used_bytes();
  return layout;
}

void place_bins(Layout& layout, cn::MonoAddress first) {
  const std::uint64_t distance = first - layout.scene_bytes;
  const auto move = [distance](auto&... bins) { ((bins.address += distance), ...); };
  move(layout.ray_bin, layout.ray_queue, layout.traversal_bin, layout.treelet_pool, layout.intersection_bin,
       layout.surface_place_bin, layout.scatter_bin, layout.lighting_bin, layout.direct_light_bin,
       layout.path_bin, layout.binned_hits, layout.casts_bin, layout.slot_states, layout.finished_bin,
       layout.path_numbers, layout.vertices, layout.folds, layout.finished, layout.pair_bin,
       layout.path_vertices, layout.light_heads, layout.results_header[0], layout.results_header[1],
       layout.results[0], layout.results[1]);
  for (Layout::Region& region : layout.regions)
    if (region.first >= layout.scene_bytes) region.first += distance;
  layout.total_bytes += distance;
}

void add_camera_samples(Layout& layout, std::uint64_t count) {
  MonoAllocator memory(layout.regions, layout.total_bytes);
  layout.camera_samples = memory.take<CameraSampleRecord>("camera samples", count);
  layout.total_bytes = memory.used_bytes();
}

}  // namespace path_tracer
