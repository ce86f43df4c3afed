#include "firmware/path_tracer/traversals/ray_unit_function.hpp"

#include <algorithm>
#include <cstring>

namespace path_tracer {
namespace {

constexpr int kUnitLanes = cn::kStripLanes;
constexpr int kWordBytes = 8;

/// A step of the unit is one node; it keeps no nodes of its own but those in its cache.
TreeShape shape_of_unit(TreeShape shape) {
  shape.resident_nodes = 0;
  shape.treelet_nodes = 1;
  shape.visits = 1;
  return shape;
}

int whole_words(int bytes) {
  return (bytes + kWordBytes - 1) / kWordBytes * kWordBytes;
}

}  // namespace

RayUnitFunction::RayUnitFunction(const TraversalKernels& kernels, const ProgramConfig& config,
                                 const Layout& layout)
    : kernels_(kernels),
      shape_(shape_of_unit(config.tree)),
      sizes_(layout.sizes),
      reach_(layout.reach),
      layers_(layout.layers),
      nodes_(layout.nodes.address),
      triangles_(layout.triangles.address),
      first_light_run_(layout.triangle_count),
      surfaces_{layout.surfaces.address, layout.sizes.surface},
      memory_(kUnitLanes, 4096 + whole_words(shape_.layout.node_bytes()) + shape_.record_bytes()),
      ray_(memory_.allocate("ray", int{sizeof(QueuedRay)})),
      record_(memory_.allocate("traversal record", shape_.record_bytes())),
      leaf_(memory_.allocate("leaf", shape_.leaf_records() * layout.layers.record_bytes())),
      node_offset_(memory_.allocate("node", shape_.layout.node_bytes()).offset_bytes),
      node_{memory_.allocate("slot of the node", kWordBytes).offset_bytes},
      hit_(memory_.allocate("hit", layout.sizes.hit)),
      surface_place_{memory_.allocate("surface place", kWordBytes).offset_bytes},
      unused_place_{memory_.allocate("places in bins", kWordBytes).offset_bytes},
      piece_(std::size_t(
          std::max(shape_.layout.node_bytes(), shape_.leaf_records() * layout.layers.record_bytes()))) {}

void RayUnitFunction::answer(const Read& mono, const std::vector<Query>& queries) {
  for (std::size_t first = 0; first < queries.size(); first += kUnitLanes)
    answer_strip(mono, queries.data() + first,
                 static_cast<int>(std::min<std::size_t>(kUnitLanes, queries.size() - first)));
}

void RayUnitFunction::answer_strip(const Read& mono, const Query* queries, int count) {
  const LaneMask rays = LaneMask::first(count);
  enter(queries, rays);
  for (LaneMask alive = rays; alive.any();) {
    LaneMask with_leaf;
    for (int lane = 0; lane < count; ++lane)
      if (alive[lane]) with_leaf.set(lane, fetch(mono, lane, *queries[lane].steps));
    alive = step(alive, with_leaf);
  }
  finish(queries, rays);
}

void RayUnitFunction::enter(const Query* queries, const LaneMask& rays) {
  for (int lane = 0; lane < kUnitLanes; ++lane) {
    if (!rays[lane]) continue;
    copy_in(lane, ray_.span().offset_bytes, queries[lane].query, query_bytes());
    queries[lane].steps->clear();
  }
  EnterArguments arguments;
  arguments.ray = ray_;
  arguments.first_light_run = first_light_run_;
  arguments.record = record_;
  arguments.treelet = node_;
  cn::IssueTree issued;
  kernels_.enter.run(arguments, memory_, rays, issued);
}

bool RayUnitFunction::fetch(const Read& mono, int lane, std::vector<cn::SearchStep>& steps) {
  using Kind = cn::SearchStep::Kind;
  const std::int32_t triangles = value(lane, record_.field(&TraversalRecord::leaf_count));
  const std::int32_t node = value(lane, record_.field(&TraversalRecord::node));
  std::uint64_t& slot = memory_.word(lane, node_.offset_bytes);
  slot = kNoTreelet;
  if (triangles > 0) {
    const int record_bytes = layers_.record_bytes();
    const std::int32_t first = value(lane, record_.field(&TraversalRecord::leaf));
    const MonoAddress from = triangles_ + std::uint64_t(first) * std::uint64_t(record_bytes);
    const int bytes = triangles * record_bytes;
    mono(from, piece_.data(), std::size_t(bytes));
    copy_in(lane, leaf_.span().offset_bytes, piece_.data(), bytes);
    steps.push_back({Kind::leaf, triangles, from, bytes});
    return true;
  }
  if (node < 0) return false;  // the next entry of the stack
  const int bytes = shape_.layout.node_bytes();
  const MonoAddress from = nodes_ + std::uint64_t(node) * std::uint64_t(bytes);
  mono(from, piece_.data(), std::size_t(bytes));
  copy_in(lane, node_offset_, piece_.data(), bytes);
  slot = std::uint64_t(std::uint32_t(node));
  steps.push_back({Kind::node, shape_.layout.width, from, bytes});
  return false;
}

LaneMask RayUnitFunction::step(const LaneMask& rays, const LaneMask& with_leaf) {
  LaneMask alive;
  TraverseArguments arguments;
  arguments.record = record_;
  arguments.leaf = leaf_;
  arguments.treelet = node_;
  arguments.tree = {shape_, 0, node_offset_};
  arguments.reach = reach_;
  arguments.layers = layers_;
  arguments.loaded_leaf = with_leaf.any() ? &with_leaf : nullptr;
  arguments.alive = &alive;
  cn::IssueTree issued;
  kernels_.traverse_through(shape_.layout).run(arguments, memory_, rays, issued);
  return alive;
}

void RayUnitFunction::finish(const Query* queries, const LaneMask& rays) {
  FinishArguments arguments;
  arguments.record = record_;
  arguments.surfaces = surfaces_;
  arguments.hit_has_tail = sizes_.hit_has_tail();
  arguments.hit = hit_;
  arguments.surface_place = surface_place_;
  arguments.hit_to = unused_place_;
  arguments.surface_place_to = unused_place_;
  cn::IssueTree issued;
  kernels_.finish.run(arguments, memory_, rays, issued);
  for (int lane = 0; lane < kUnitLanes; ++lane) {
    if (!rays[lane]) continue;
    copy_out(lane, hit_.span().offset_bytes, queries[lane].answers[0], sizes_.hit);
    copy_out(lane, surface_place_.offset_bytes, queries[lane].answers[1], int{sizeof(MonoAddress)});
  }
}

void RayUnitFunction::copy_in(int lane, int offset_bytes, const std::uint8_t* from, int bytes) {
  for (int at = 0; at < bytes; at += kWordBytes)
    std::memcpy(&memory_.word(lane, offset_bytes + at), from + at,
                std::size_t(std::min(kWordBytes, bytes - at)));
}

void RayUnitFunction::copy_out(int lane, int offset_bytes, std::uint8_t* to, int bytes) const {
  for (int at = 0; at < bytes; at += kWordBytes)
    std::memcpy(to + at, &memory_.word(lane, offset_bytes + at), kWordBytes);
}

std::int32_t RayUnitFunction::value(int lane, PolyField<std::int32_t> field) const {
  const std::uint64_t word = memory_.word(lane, field.offset_bytes / kWordBytes * kWordBytes);
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(word >> (field.offset_bytes % kWordBytes * 8)));
}

}  // namespace path_tracer
