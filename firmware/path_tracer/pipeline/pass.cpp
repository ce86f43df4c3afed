#include "firmware/path_tracer/pipeline/pass.hpp"

namespace path_tracer {

void count_pass(const std::vector<int>& blocks, const Bins& bins, RunCounts& counts) {
  std::uint64_t rays = 0;
  for (const int index : blocks) {
    const Bins::Block& block = bins.blocks[std::size_t(index)];
    rays += std::uint64_t(block.segment_count + block.shadow_ray_count);
    counts.segments += std::uint64_t(block.segment_count);
    counts.shadow_rays += std::uint64_t(block.shadow_ray_count);
  }
  if (rays > 0) counts.rays.add(rays);
  counts.blocks += blocks.size();
  if (!blocks.empty()) counts.skipped_blocks += bins.blocks.size() - blocks.size();
}

}  // namespace path_tracer
