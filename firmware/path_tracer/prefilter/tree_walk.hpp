#pragma once

#include "firmware/path_tracer/geometry/triangle.hpp"
#include "firmware/path_tracer/prefilter/prefilter_search.hpp"
#include "firmware/path_tracer/prefilter/search_tree.hpp"

/// Brute force as a machine without a clock executes it: each lane walks through the simulator's tree, and
/// all lanes test one triangle each at a time.
///
/// No box is missed. With u = 2^-24: origins are below 2 units and have an error of 2 u, which the boxes
/// include. Differences of a plane and an origin are off by u of their own, inverse directions by 2 u, and
/// their product by 1 u more; entries and exits are moved apart by 8 u of their own.
namespace path_tracer {

/// A lane's way through the tree.
class LaneWalk {
 public:
  void begin(const SearchTree& tree, const vec3<double>& origin, const vec3<double>& direction,
             std::int32_t left_face) {
    const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    const double scale = std::ldexp(1.0, -std::ilogb(largest));
    const vec3<double> from = (origin - tree.anchor) * tree.unit;
    origin_ = {float(from.x), float(from.y), float(from.z)};
    inverse_ = {inverse(direction.x * scale), inverse(direction.y * scale), inverse(direction.z * scale)};
    distance_unit_ = tree.unit / scale;
    latest_ = std::numeric_limits<float>::infinity();
    left_face_ = left_face;
    stack_size_ = 0;
    leaf_ = {};
    push(0.0f, 0);
  }

  /// A hit at this distance along the ray makes all boxes behind it needless.
  void hit_at(double distance) {
    constexpr double kFarther = 1 + 0x1p-20;
    latest_ = float(distance * distance_unit_ * kFarther);
  }

  /// The next triangle whose box the ray meets; -1 if none is left.
  int next(const SearchTree& tree, const MonoTriangles& triangles) {
    while (true) {
      while (leaf_.count > 0) {
        --leaf_.count;
        const int triangle = tree.order[std::size_t(leaf_.first++)];
        if (triangles(triangle).face != left_face_) return triangle;
      }
      if (stack_size_ == 0) return -1;
      const Entry entry = stack_[--stack_size_];
      if (entry.entry > latest_) continue;
      if (entry.child >= SearchTree::kFirstLeaf) {
        leaf_ = tree.leaves[entry.child - SearchTree::kFirstLeaf];
      } else {
        visit(tree.nodes[entry.child]);
      }
    }
  }

 private:
  using FloatChunk = prefilter_detail::FloatChunk;
  static constexpr int kInChunk = prefilter_detail::kLanesOfChunk;
  static constexpr int kStack = SearchTree::kMostLevels * (SearchNode::kChildren - 1) + 1;
  struct Entry {
    float entry;
    std::uint32_t child;
  };

  static float inverse(double component) {
    constexpr double kLeast = 1e-20;  // a ray that leaves a plane more slowly does not leave it
    return float(1.0 / (std::abs(component) < kLeast ? std::copysign(kLeast, component) : component));
  }
  void push(float entry, std::uint32_t child) { stack_[stack_size_++] = {entry, child}; }

  /// Pushes the children that the ray meets, the nearest last.
  void visit(const SearchNode& node) {
    using prefilter_detail::greater;
    using prefilter_detail::lesser;
    using prefilter_detail::same;
    constexpr float kEarlier = 1 - 0x1p-20f;
    constexpr float kLater = 1 + 0x1p-20f;
    alignas(64) float entries[SearchNode::kChildren];
    unsigned meets = 0;
    for (int first = 0; first < SearchNode::kChildren; first += kInChunk) {
      FloatChunk entry = same(0.0f);
      FloatChunk exit = same(latest_);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const FloatChunk lower = chunk_at(node.lower[axis] + first);
        const FloatChunk upper = chunk_at(node.upper[axis] + first);
        const FloatChunk a = (lower - origin_[axis]) * inverse_[axis];
        const FloatChunk b = (upper - origin_[axis]) * inverse_[axis];
        entry = greater(entry, lesser(a, b) * kEarlier);
        exit = lesser(exit, greater(a, b) * kLater);
      }
      std::memcpy(entries + first, &entry, sizeof(entry));
      meets |= (~prefilter_detail::signs(exit - entry) & ((1u << kInChunk) - 1)) << first;
    }
    meets &= node.present;
    const int bottom = stack_size_;
    for (; meets != 0; meets &= meets - 1) {
      const int child = __builtin_ctz(meets);
      int place = stack_size_++;
      for (; place > bottom && stack_[place - 1].entry < entries[child]; --place)
        stack_[place] = stack_[place - 1];
      stack_[place] = {entries[child], node.child[child]};
    }
  }

  static FloatChunk chunk_at(const float* from) {
    FloatChunk chunk;
    std::memcpy(&chunk, from, sizeof(chunk));
    return chunk;
  }

  std::array<float, 3> origin_{};
  std::array<float, 3> inverse_{};
  double distance_unit_ = 1;
  float latest_ = 0;
  std::int32_t left_face_ = kNoFace;
  SearchLeaf leaf_;
  int stack_size_ = 0;
  Entry stack_[kStack];
};

/// The walks of a strip's enabled lanes.
class StripWalk {
 public:
  StripWalk(const RayOperands& ray, const SearchTree& tree, const MonoTriangles& triangles)
      : tree_(tree), triangles_(triangles), active_(cn::mask_bits(cn::strip.enabled)) {
    const auto doubles = [](const poly<double>& from, double(&to)[cn::kStripLanes]) {
      cn::store_lanes(to, from.lanes());
    };
    double origin[3][cn::kStripLanes];
    double direction[3][cn::kStripLanes];
    doubles(ray.origin.x, origin[0]);
    doubles(ray.origin.y, origin[1]);
    doubles(ray.origin.z, origin[2]);
    doubles(ray.direction.x, direction[0]);
    doubles(ray.direction.y, direction[1]);
    doubles(ray.direction.z, direction[2]);
    std::int64_t left_face[cn::kStripLanes];
    cn::store_lanes(left_face, ray.left_face.lanes());
    for (int lane = 0; lane < cn::kStripLanes; ++lane)
      if ((active_ >> lane & 1u) != 0)
        walk_[lane].begin(tree_, {origin[0][lane], origin[1][lane], origin[2][lane]},
                          {direction[0][lane], direction[1][lane], direction[2][lane]},
                          static_cast<std::int32_t>(left_face[lane]));
  }

  /// Gives each lane that has one left its next triangle, the others any. Returns the lanes that have one.
  unsigned next(const TriangleRecord* (&at)[cn::kStripLanes]) {
    const TriangleRecord* any = nullptr;
    for (int lane = 0; lane < cn::kStripLanes; ++lane) {
      at[lane] = nullptr;
      if ((active_ >> lane & 1u) == 0) continue;
      const int triangle = walk_[lane].next(tree_, triangles_);
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

  void hits_at(const poly<double>& distance, unsigned lanes) {
    double distances[cn::kStripLanes];
    cn::store_lanes(distances, distance.lanes());
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      walk_[lane].hit_at(distances[lane]);
    }
  }

 private:
  const SearchTree& tree_;
  const MonoTriangles& triangles_;
  unsigned active_;
  LaneWalk walk_[cn::kStripLanes];
};

/// search() of all triangles by way of the simulator's tree: the same result, and no charge.
template <class Found>
void search_tree(const RayOperands& ray, double reach, const MonoTriangles& triangles, const SearchTree& tree,
                 Found& nearest) {
  if (tree.empty()) return;
  StripWalk walk(ray, tree, triangles);
  const TriangleRecord* at[cn::kStripLanes];
  for (unsigned left = walk.next(at); left != 0; left = walk.next(at)) {
    const PolyTriangle triangle = LaneTriangles(at).load(ray.is_in_layers);
    const Crossing crossing(ray, triangle);
    const mask candidate = crossing.inside & mask(cn::mask_from_bits(left));
    mask in_box = is_certain(crossing.determinant, ray);
    cn::poly_if_any(candidate & !in_box,
                    [&] { in_box = in_box | meets_padded_box(ray, reach, crossing, triangle); });
    const mask better = candidate & in_box & comes_before(ray, crossing, triangle.number, nearest);
    cn::poly_if(better, [&] { nearest.take(crossing, triangle); });
    walk.hits_at(nearest.distance / cn::abs(nearest.determinant),
                 cn::mask_bits(better.lanes()) & cn::mask_bits(cn::strip.enabled));
  }
}

}  // namespace path_tracer
