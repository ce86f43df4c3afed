#include "firmware/path_tracer/program.hpp"

namespace path_tracer {
namespace {

/// Hands out mono memory from address 0 upwards, in whole DDR packets.
class MonoAllocator {
 public:
  template <class T>
  cn::MonoPointer<T> take(std::uint64_t count) {
    const cn::MonoPointer<T> start{next_};
    next_ = (next_ + count * sizeof(T) + kAlignment - 1) / kAlignment * kAlignment;
    return start;
  }
  std::uint64_t used_bytes() const { return next_; }

 private:
  static constexpr std::uint64_t kAlignment = 64;
  std::uint64_t next_ = 0;
};

void require(bool ok, const std::string& what, const std::string& found, const std::string& allowed) {
  if (!ok) throw ProgramError(what + ": found " + found + ", allowed is " + allowed);
}

}  // namespace

void validate(const ProgramConfig& config) {
  require(config.n >= 0 && config.n <= kMaxBuffers, "n", std::to_string(config.n),
          "0 to " + std::to_string(kMaxBuffers));
  require(config.bin_blocks >= 1 && config.bin_blocks <= kMaxBinBlocks, "bin length",
          std::to_string(config.bin_blocks) + " blocks", "1 to " + std::to_string(kMaxBinBlocks));
  // Paper, section 3.3: "the bins must be at least n * (number of PEs) in length".
  require(config.n <= config.bin_blocks, "n", std::to_string(config.n),
          "at most the bin length, " + std::to_string(config.bin_blocks) + " blocks");
  require(config.slot_vertices >= kVerticesPerLoad && config.slot_vertices <= kMaxSlotVertices &&
              config.slot_vertices % kVerticesPerLoad == 0,
          "vertices a path slot", std::to_string(config.slot_vertices),
          "a positive multiple of " + std::to_string(kVerticesPerLoad) + " up to " +
              std::to_string(kMaxSlotVertices));
  require(config.roulette_start >= 0, "roulette start", std::to_string(config.roulette_start),
          "0 or more segments");
  require(config.max_survival > 0 && config.max_survival < 1, "largest survival probability",
          std::to_string(config.max_survival), "above 0 and below 1");
}

Layout make_layout(int triangle_count, int light_count, int num_pes, const ProgramConfig& config) {
  const auto slots = std::uint64_t(num_pes) * std::uint64_t(config.bin_blocks);
  MonoAllocator memory;
  Layout layout;
  layout.triangle_count = triangle_count;
  layout.light_count = light_count;
  layout.camera = memory.take<CameraRecord>(1);
  layout.triangles = memory.take<TriangleRecord>(std::uint64_t(triangle_count));
  layout.surfaces = memory.take<SurfaceRecord>(std::uint64_t(triangle_count));
  layout.lights = memory.take<LightRecord>(std::uint64_t(light_count));
  layout.light_cdf = memory.take<double>(std::uint64_t(light_count));
  layout.scene_bytes = memory.used_bytes();
  layout.ray_bin = memory.take<RayRecord>(slots);
  layout.intersection_bin = memory.take<HitRecord>(slots);
  layout.scatter_bin = memory.take<ScatterRecord>(slots);
  layout.lighting_bin = memory.take<LightingRecord>(slots);
  layout.direct_light_bin = memory.take<DirectLightRecord>(slots);
  layout.path_bin = memory.take<PathRecord>(slots);
  layout.vertices = memory.take<VertexRecord>(slots * std::uint64_t(config.slot_vertices));
  layout.folds = memory.take<FoldRecord>(slots);
  layout.finished = memory.take<FinishedRecord>(slots);
  for (auto& header : layout.results_header) header = memory.take<ResultsHeader>(1);
  for (auto& half : layout.results) half = memory.take<RadianceRecord>(slots);
  layout.total_bytes = memory.used_bytes();
  return layout;
}

}  // namespace path_tracer
