#include "firmware/path_tracer/program/run_counts.hpp"

#include <algorithm>

namespace path_tracer {
namespace {

void add_by_place(std::vector<std::uint64_t>& sums, const std::vector<std::uint64_t>& others) {
  sums.resize(std::max(sums.size(), others.size()));
  for (std::size_t i = 0; i < others.size(); ++i) sums[i] += others[i];
}

}  // namespace

void PassCounts::add(std::uint64_t count) {
  if (passes_ == passes_per_interval_ * kMaxIntervals) coarsen();
  if (passes_ == passes_per_interval_ * intervals_.size()) intervals_.push_back(0);
  intervals_.back() += count;
  ++passes_;
}

void PassCounts::merge(PassCounts other) {
  while (passes_per_interval_ < other.passes_per_interval_) coarsen();
  while (other.passes_per_interval_ < passes_per_interval_) other.coarsen();
  add_by_place(intervals_, other.intervals_);
  passes_ = std::max(passes_, other.passes_);
}

void PassCounts::coarsen() {
  for (std::size_t i = 0; i < intervals_.size(); i += 2)
    intervals_[i / 2] = intervals_[i] + (i + 1 < intervals_.size() ? intervals_[i + 1] : 0);
  intervals_.resize((intervals_.size() + 1) / 2);
  passes_per_interval_ *= 2;
}

void TraversalCounts::merge(const TraversalCounts& other) {
  leaf_loads += other.leaf_loads;
  treelet_loads += other.treelet_loads;
  add_by_place(rays, other.rays);
  add_by_place(lanes, other.lanes);
  rays_before_tail += other.rays_before_tail;
  lanes_before_tail += other.lanes_before_tail;
}

void RunCounts::merge(const RunCounts& other) {
  paths += other.paths;
  segments += other.segments;
  shadow_rays += other.shadow_rays;
  culled_shadow_rays += other.culled_shadow_rays;
  folds += other.folds;
  blocks += other.blocks;
  skipped_blocks += other.skipped_blocks;
  steps += other.steps;
  add_by_place(paths_by_segments, other.paths_by_segments);
  rays.merge(other.rays);
  traversal.merge(other.traversal);
  connections.light_segments += other.connections.light_segments;
  connections.to_lens += other.connections.to_lens;
  connections.to_lights += other.connections.to_lights;
  connections.to_light_vertices += other.connections.to_light_vertices;
}

}  // namespace path_tracer
