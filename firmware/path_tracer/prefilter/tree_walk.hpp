#pragma once

#include "firmware/path_tracer/prefilter/prefilter_search.hpp"
#include "firmware/path_tracer/prefilter/ray_walk.hpp"

/// Brute force as a machine without a clock executes it: all lanes are tested with the scene's large
/// triangles, each lane walks through the simulator's tree of the others, and the firmware's test of what may
/// be crossed takes one triangle for each lane at a time.
namespace path_tracer {

/// A strip's rays against the tree's large triangles.
class LargeTest {
 public:
  LargeTest(const PrefilterRay& ray, const std::vector<LargeTriangle>& large) {
    constexpr int kInChunk = prefilter_detail::kLanesOfChunk;
    for (int i = 0; i < prefilter_detail::Floats::kChunks; ++i) {
      const prefilter_detail::FloatChunk length_bound = ray.length_bound(i);
      for (std::size_t k = 0; k < large.size(); ++k) {
        const prefilter_detail::FloatCrossing at = ray.crossing(large[k].triangle, i);
        CrossingBounds bounds(at, ray.leaves(large[k].triangle, i));
        if (bounds.may == 0) continue;
        bounds.set_others(at, length_bound * large[k].certain_determinant);
        may_[k] = std::uint8_t(may_[k] | bounds.may << (i * kInChunk));
        certain_[k] = std::uint8_t(certain_[k] | bounds.certain << (i * kInChunk));
        std::memcpy(earliest_[k] + i * kInChunk, &bounds.earliest, sizeof(bounds.earliest));
        std::memcpy(latest_[k] + i * kInChunk, &bounds.latest, sizeof(bounds.latest));
      }
    }
  }
  /// Tells a lane's walk which ones its ray may cross.
  void tell(int lane, const std::vector<LargeTriangle>& large, RayWalk& walk) const {
    const int place = cn::place_of_lane<float>(lane);
    for (std::uint64_t left = bit_of_each(may_, place); left != 0; left &= left - 1) {
      const int k = __builtin_ctzll(left);
      walk.meet(large[std::size_t(k)], earliest_[k][place], latest_[k][place],
                (certain_[k] >> place & 1u) != 0);
    }
  }

 private:
  std::uint8_t may_[64] = {};  ///< for each triangle the lanes, in the order of floats
  std::uint8_t certain_[SearchTree::kMostLarge] = {};
  float earliest_[SearchTree::kMostLarge][cn::kStripLanes];
  float latest_[SearchTree::kMostLarge][cn::kStripLanes];
};

/// The walks of a strip's enabled lanes.
class StripWalk {
 public:
  /// @param light_face of shadow rays whose nearest hit matters only if it is their light; kNoFace of others
  StripWalk(const RayOperands& ray, const poly<std::int32_t>& light_face, const SearchTree& tree,
            const MonoTriangles& triangles)
      : tree_(tree), triangles_(triangles), active_(cn::mask_bits(cn::strip.enabled)) {
    const PrefilterRay in_floats(ray, tree.anchor, tree.unit);
    const LargeTest large(in_floats, tree.large);
    std::int64_t left_face[cn::kStripLanes];
    std::int64_t light[cn::kStripLanes];
    double scale[cn::kStripLanes];
    cn::store_lanes(left_face, ray.left_face.lanes());
    cn::store_lanes(light, light_face.lanes());
    cn::store_lanes(scale, in_floats.scale().lanes());
    for (unsigned lanes = active_; lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      walk_[lane].begin(tree_,
                        {in_floats.origin(lane), in_floats.direction(lane), tree_.unit / scale[lane],
                         static_cast<std::int32_t>(left_face[lane]), static_cast<std::int32_t>(light[lane])});
      large.tell(lane, tree_.large, walk_[lane]);
    }
  }

  /// Gives each lane that has one left its next triangle, the others any. Returns the lanes that have one.
  unsigned next(const TriangleRecord* (&at)[cn::kStripLanes]) {
    const TriangleRecord* any = nullptr;
    for (int lane = 0; lane < cn::kStripLanes; ++lane) {
      at[lane] = nullptr;
      if ((active_ >> lane & 1u) == 0) continue;
      const int triangle = walk_[lane].next(tree_);
      if (triangle < 0) {
        active_ &= ~(1u << lane);
      } else {
        any = at[lane] = &triangles_(triangle);
      }
    }
    for (const TriangleRecord*& triangle : at)
      if (triangle == nullptr) triangle = any;
    return active_;
  }

  /// The lanes whose walk is not over.
  unsigned going_on() const {
    unsigned lanes = 0;
    for (int lane = 0; lane < cn::kStripLanes; ++lane)
      lanes |= static_cast<unsigned>(!walk_[lane].is_over()) << lane;
    return lanes & active_;
  }

  /// @param at the triangles that these lanes hit
  void hits_at(const poly<double>& distance, const TriangleRecord* const (&at)[cn::kStripLanes],
               unsigned lanes) {
    double distances[cn::kStripLanes];
    cn::store_lanes(distances, distance.lanes());
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      walk_[lane].hit_at(distances[lane], at[lane]->face);
    }
  }

 private:
  const SearchTree& tree_;
  const MonoTriangles& triangles_;
  unsigned active_;
  RayWalk walk_[cn::kStripLanes];
};

/// Takes the triangles of those lanes where they are hit and come before `nearest`. Returns the lanes that
/// do.
inline mask take_if_before(const RayOperands& ray, double reach,
                           const TriangleRecord* const (&at)[cn::kStripLanes], unsigned lanes,
                           Nearest& nearest) {
  const PolyTriangle triangle = LaneTriangles(at).load(ray.is_in_layers);
  const Crossing crossing(ray, triangle);
  const mask candidate = crossing.inside & mask(cn::mask_from_bits(lanes));
  mask in_box = is_certain(crossing.determinant, ray);
  cn::poly_if_any(candidate & !in_box,
                  [&] { in_box = in_box | meets_padded_box(ray, reach, crossing, triangle); });
  const mask better = candidate & in_box & comes_before(ray, crossing, triangle.number, nearest);
  cn::poly_if(better, [&] { nearest.take(crossing, triangle); });
  return better;
}

/// search() of all triangles by way of the simulator's tree: the same result, and no charge. A shadow ray
/// that does not see its light hits something that is in its way, not always the nearest.
/// @param light_face as of StripWalk
inline void search_tree(const RayOperands& ray, const poly<std::int32_t>& light_face, double reach,
                        const MonoTriangles& triangles, const SearchTree& tree, Nearest& nearest) {
  if (tree.empty()) return;
  StripWalk walk(ray, light_face, tree, triangles);
  const TriangleRecord* at[cn::kStripLanes];
  for (unsigned left = walk.next(at); left != 0; left = walk.next(at)) {
    const mask better = take_if_before(ray, reach, at, left, nearest);
    const unsigned news = walk.going_on() & cn::mask_bits(better.lanes()) & cn::mask_bits(cn::strip.enabled);
    if (news != 0) walk.hits_at(nearest.distance / cn::abs(nearest.determinant), at, news);
  }
}

}  // namespace path_tracer
