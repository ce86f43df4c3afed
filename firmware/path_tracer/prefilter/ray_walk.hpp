#pragma once

#include <algorithm>
#include <functional>
#include <limits>

#include "firmware/path_tracer/prefilter/prefilter_ray.hpp"
#include "firmware/path_tracer/prefilter/search_tree.hpp"

namespace path_tracer {

/// A ray in single precision: from the tree's anchor in its unit, and the direction scaled as PrefilterRay's.
struct WalkRay {
  std::array<float, 3> origin;
  std::array<float, 3> direction;
  double distance_unit;  ///< of a distance along the direction, in units along the scaled one
  std::int32_t left_face;
  std::int32_t light_face;  ///< kNoFace: the nearest hit is wanted
};

/// One ray's way through the simulator's tree, in single precision. It names the triangles that the
/// firmware's test must look at: those that the ray may cross, as far as no certain crossing is nearer.
///
/// No box is missed. With u = 2^-24: origins are below 2 units and have an error of 2 u, which the boxes
/// include. Differences of a plane and an origin are off by u of their own, inverse directions by 2 u, and
/// their product by 1 u more; entries and exits are moved apart by 8 u of their own.
///
/// Numerators and determinants are known to kPrefilterMargin, so distances lie between two quotients. A
/// crossing is certain if it is one with all margins against it and in the triangle's padded box for certain.
///
/// A shadow ray is over when something is nearer than its light. All triangles of the light's face are
/// candidates from the start; what is certainly nearer than each of them hides the light.
class RayWalk {
 public:
  void begin(const SearchTree& tree, const WalkRay& ray) {
    ray_ = ray;
    length_bound_ = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      inverse_[axis] = inverse(ray.direction[axis]);
      near_[axis] = std::signbit(ray.direction[axis]) ? 1 : 0;
      length_bound_ += std::abs(ray.direction[axis]) * kLater;
    }
    latest_ = before_light_ = kInfinite;
    known_face_ = kNoFace;
    candidate_count_ = 0;
    waits_ = is_occluded_ = is_hidden_ = false;
    stack_[0] = key(0.0f, 0);
    stack_size_ = 1;
    find_light(tree);
  }

  /// @param latest if the crossing is certain
  void meet(const LargeTriangle& large, float earliest, float latest, bool is_certain) {
    if (!seeks_light() || large.triangle.face != known_face_)
      meet(Candidate{earliest, large.index}, latest, is_certain);
  }

  /// The next triangle to test; -1 if none is left.
  int next(const SearchTree& tree) {
    while (true) {
      if (waits_ || stack_size_ == 0) {
        while (candidate_count_ > 0) {
          const Candidate& candidate = candidates_[--candidate_count_];
          if (candidate.earliest <= latest_) return candidate.triangle;
        }
        if (stack_size_ == 0 || is_occluded_) return -1;
        waits_ = false;
      }
      go_on(tree);
    }
  }

  /// Whether it names no more triangles.
  bool is_over() const { return stack_size_ == 0 && candidate_count_ == 0; }

  /// The nearest of the triangles named so far. What is behind it is needless.
  void hit_at(double distance, std::int32_t face) {
    constexpr double kFarther = 1 + 0x1p-20;
    latest_ = std::min(latest_, float(distance * ray_.distance_unit * kFarther));
    is_occluded_ = seeks_light() && face != ray_.light_face;
  }

 private:
  using FloatChunk = prefilter_detail::FloatChunk;
  static constexpr int kInChunk = prefilter_detail::kLanesOfChunk;
  static constexpr float kInfinite = std::numeric_limits<float>::infinity();
  static constexpr float kEarlier = CrossingBounds::kEarlier;
  static constexpr float kLater = CrossingBounds::kLater;
  static constexpr int kStack = SearchTree::kMostLevels * (SearchNode::kChildren - 1) + 1;
  static constexpr int kCandidates = SearchTree::kMostLarge + 4 * SearchLeaf::kTriangles;
  /// A child and where the ray enters its box, above it: entries are positive, so keys are in their order.
  using Key = std::uint64_t;
  struct Candidate {
    float earliest;
    std::int32_t triangle;
  };
  static float inverse(float component) {
    constexpr float kLeast = 1e-20f;  // a ray that leaves a plane more slowly does not leave it
    return 1.0f / (std::abs(component) < kLeast ? std::copysign(kLeast, component) : component);
  }
  bool seeks_light() const { return known_face_ != kNoFace; }
  static Key key(float entry, std::uint32_t child) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &entry, sizeof(bits));
    return Key{bits} << 32 | child;
  }
  static std::uint32_t child_of(Key key) { return static_cast<std::uint32_t>(key); }
  static float entry_of(Key key) {
    const auto bits = static_cast<std::uint32_t>(key >> 32);
    float entry = 0;
    std::memcpy(&entry, &bits, sizeof(entry));
    return entry;
  }

  /// Walks on until candidates must be tested or the tree is done.
  void go_on(const SearchTree& tree) {
    while (stack_size_ > 0 && !waits_) {
      Key at = stack_[--stack_size_];
      if (entry_of(at) > latest_) continue;
      while (child_of(at) < SearchTree::kFirstLeaf && visit(tree.nodes[child_of(at)]))
        at = stack_[--stack_size_];
      if (child_of(at) >= SearchTree::kFirstLeaf) visit(tree.leaves[child_of(at) - SearchTree::kFirstLeaf]);
    }
  }

  /// Pushes the children that the ray meets, the nearest last. Returns whether there is one.
  bool visit(const SearchNode& node) {
    alignas(64) float entries[SearchNode::kChildren];
    unsigned meets = boxes_met(node, entries);
    if (meets == 0) return false;
    Key* const first = stack_ + stack_size_;
    Key* end = first;
    for (; meets != 0; meets &= meets - 1) {
      const int child = __builtin_ctz(meets);
      *end++ = key(entries[child], node.child[child]);
    }
    stack_size_ += static_cast<int>(end - first);
    sort_down(first, end);
    return true;
  }

  static void order(Key& a, Key& b) {
    const Key farther = std::max(a, b);
    b = std::min(a, b);
    a = farther;
  }
  /// Two and three children are sorted without branches, which the processor could not predict.
  static void sort_down(Key* first, Key* end) {
    const auto count = end - first;
    if (count < 2) return;
    if (count > 3) return std::sort(first, end, std::greater<>());
    order(first[0], first[1]);
    if (count == 2) return;
    order(first[1], first[2]);
    order(first[0], first[1]);
  }

  unsigned boxes_met(const SearchNode& node, float (&entries)[SearchNode::kChildren]) const {
    using prefilter_detail::chunk_at;
    using prefilter_detail::greater;
    using prefilter_detail::lesser;
    using prefilter_detail::same;
    unsigned meets = 0;
    for (int first = 0; first < SearchNode::kChildren; first += kInChunk) {
      const auto distance = [&](std::size_t side, std::size_t axis) {
        return (chunk_at(node.plane[side][axis] + first) - ray_.origin[axis]) * inverse_[axis];
      };
      const FloatChunk entry =
          greater(greater(distance(near_[0], 0), distance(near_[1], 1)), distance(near_[2], 2));
      const FloatChunk exit =
          lesser(lesser(distance(1 - near_[0], 0), distance(1 - near_[1], 1)), distance(1 - near_[2], 2));
      const FloatChunk begin = greater(entry * kEarlier, same(0.0f));
      const FloatChunk end = lesser(exit * kLater, same(latest_));
      std::memcpy(entries + first, &begin, sizeof(begin));
      meets |= (~prefilter_detail::signs(end - begin) & prefilter_detail::kAllOfChunk) << first;
    }
    return meets;
  }

  void visit(const SearchLeaf& leaf) {
    for (int first = 0; first < leaf.count; first += kInChunk) {
      const prefilter_detail::FloatCrossing at = crossing(leaf, first);
      CrossingBounds bounds(at, ignored_faces(leaf.face + first));
      bounds.may &= (1u << (leaf.count - first)) - 1;
      if (bounds.may == 0) continue;
      bounds.set_others(at, prefilter_detail::chunk_at(leaf.certain_determinant + first) * length_bound_);
      for (unsigned left = bounds.may; left != 0; left &= left - 1) {
        const int i = __builtin_ctz(left);
        meet({bounds.earliest[i], leaf.index[first + i]}, bounds.latest[i], (bounds.certain >> i & 1u) != 0);
      }
    }
    if (candidate_count_ > kCandidates - SearchLeaf::kTriangles) waits_ = true;
  }

  prefilter_detail::FloatCrossing crossing(const SearchLeaf& leaf, int first) const {
    using prefilter_detail::chunk_at;
    const auto vector_at = [&](const float(&of)[3][SearchLeaf::kTriangles]) {
      return prefilter_detail::Vector{chunk_at(of[0] + first), chunk_at(of[1] + first),
                                      chunk_at(of[2] + first)};
    };
    const prefilter_detail::Vector vertex = vector_at(leaf.vertex);
    const prefilter_detail::Vector to_vertex{vertex.x - ray_.origin[0], vertex.y - ray_.origin[1],
                                             vertex.z - ray_.origin[2]};
    return {prefilter_detail::same(ray_.direction), to_vertex, vector_at(leaf.back),
            vector_at(leaf.minus_edge1), vector_at(leaf.edge2)};
  }

  /// @param latest of a certain crossing
  void meet(const Candidate& candidate, float latest, bool is_certain) {
    if (candidate.earliest > latest_ || is_hidden_) return;
    if (!is_certain) {
      waits_ = true;
    } else if (seeks_light() && latest < before_light_) {
      return hide_light(candidate);
    } else {
      latest_ = std::min(latest_, latest);
    }
    candidates_[candidate_count_++] = candidate;
  }
  /// The walk ends with something that is nearer than the light for certain.
  void hide_light(const Candidate& candidate) {
    is_hidden_ = true;
    candidates_[0] = candidate;
    candidate_count_ = 1;
    stack_size_ = 0;
  }

  /// The face that the ray leaves, and once the light's triangles are candidates those of its face.
  prefilter_detail::Bits ignored_faces(const std::int32_t* from) const {
    prefilter_detail::Bits face;
    std::memcpy(&face, from, sizeof(face));
    return (face == prefilter_detail::same_bits(ray_.left_face)) |
           (face == prefilter_detail::same_bits(known_face_));
  }

  /// Makes the light's triangles candidates.
  void find_light(const SearchTree& tree) {
    if (ray_.light_face < 0 || std::size_t(ray_.light_face) >= tree.light_leaf.size()) return;
    const std::int32_t leaf = tree.light_leaf[std::size_t(ray_.light_face)];
    if (leaf == SearchTree::kNoLeaf) return;
    visit(tree.leaves[std::size_t(leaf)]);
    for (int i = 0; i < candidate_count_; ++i)
      before_light_ = std::min(before_light_, candidates_[i].earliest);
    known_face_ = ray_.light_face;
    waits_ = false;
  }

  WalkRay ray_;
  std::array<float, 3> inverse_;
  std::array<std::uint32_t, 3> near_;  ///< the side of boxes where the ray enters, of each axis
  float length_bound_;                 ///< of the scaled direction, as of length_bound()
  float latest_;                       ///< no crossing behind it is wanted
  float before_light_;  ///< what ends before it is nearer than all that the ray may hit of its light's face
  std::int32_t known_face_;  ///< the light's, if all its triangles are or were candidates; else kNoFace
  bool waits_;               ///< candidates must be tested before the walk goes on
  bool is_hidden_;           ///< something hides the light for certain
  bool is_occluded_;         ///< the nearest hit so far is not of the light's face
  int candidate_count_;
  int stack_size_;
  Candidate candidates_[kCandidates];
  Key stack_[kStack];
};

}  // namespace path_tracer
