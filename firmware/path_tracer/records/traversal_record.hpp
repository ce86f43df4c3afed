#pragma once

#include "firmware/path_tracer/records/node_layout.hpp"
#include "firmware/path_tracer/records/records.hpp"

namespace path_tracer {

/// Values of TraversalRecord::node that are no slot.
inline constexpr std::int32_t kNextOnStack = -1;
inline constexpr std::int32_t kTraversalOver = -2;

/// First slot of a treelet that contains no slot.
inline constexpr std::int32_t kNoTreelet = 1 << 30;

/// A ray in a tree traversal: what it found so far and where it continues. The entries of its short stack
/// follow it, 8 bytes each.
///
/// Children of a node are visited in the order of their entries. For each level, `trail` counts the children
/// that the path from the root has passed, in as many bits as that takes, and `more` has a bit if siblings
/// are still to come. The short stack holds the latest of those. When it has lost the older ones, the ray
/// starts again at the root and follows the trail (Laine, "Restart Trail for Stackless BVH Traversal", HPG
/// 2010; Vaidyanathan, Woop, Benthin, "Wide BVH Traversal with a Short Stack", HPG 2019). So no depth and no
/// stack loses a hit.
struct TraversalRecord {
  vec3<double> origin{};
  vec3<double> direction{};
  double distance = 0;  ///< of the nearest hit, scaled by |determinant|
  double determinant = 0;
  std::uint64_t trail = 0;
  std::int32_t number = -1;  ///< of the nearest triangle
  std::int32_t left_face = kNoFace;
  /// Face of a shadow ray's light that the ray has hit or is about to test: any nearer hit ends the ray.
  std::int32_t light_face = kNoFace;
  std::int32_t slot = 0;        ///< that the ray belongs to
  std::int32_t node = 0;        ///< to visit next: a slot of the tree, kNextOnStack or kTraversalOver
  std::int32_t level = 0;       ///< of that node; the root's is 0
  std::int32_t leaf = 0;        ///< to test before visiting `node`: its first triangle
  std::int32_t leaf_count = 0;  ///< number of its triangles
  std::uint32_t more = 0;
  std::int32_t stack = 0;  ///< place of the next entry in 16 bits; the number of entries above
};

/// An entry of the short stack: where its box is entered (node_ray.hpp), and the reference of the child,
/// flagged if it is the last of its siblings.
inline constexpr int kStackEntryBytes = 8;

/// Bits of the trail for each level, which counts from 0 to the width.
constexpr int trail_bits(int width) {
  int bits = 1;
  while (width >> bits > 0) ++bits;
  return bits;
}
/// Levels that the trail has room for: 32, 21 or 16.
constexpr int max_tree_levels(int width) {
  return 64 / trail_bits(width);
}

inline constexpr int kMaxStackEntries = 32;
inline constexpr int kMaxLeafTriangles = 8;
inline constexpr int kMaxVisits = 1024;
inline constexpr int kMaxTreeletNodes = 1024;  ///< far beyond what a PE's SRAM holds

/// The triangle array ends with copies of the lights' triangles, this many for each light. Shadow rays begin
/// with them.
inline constexpr int kLightRun = 2;

/// The tree as kernels see it.
struct TreeShape {
  NodeLayout layout;
  int resident_nodes = 8;  ///< slots [0, resident_nodes) stay in every PE's SRAM
  int treelet_nodes = 2;   ///< further slots are loaded this many at a time
  int leaf_triangles = 2;  ///< maximum of a leaf
  int stack_entries = 8;   ///< a power of two, or 0
  /// Maximum number of nodes that a ray visits in a turn; 0: all that are in SRAM. All PEs take as many steps
  /// as the PE with the most. So a ray with many steps does better to continue in the next turn, beside other
  /// such rays.
  int visits = 4;

  int resident_bytes() const { return resident_nodes * layout.node_bytes(); }
  int treelet_bytes() const { return treelet_nodes * layout.node_bytes(); }
  int record_bytes() const {
    return static_cast<int>(sizeof(TraversalRecord)) + stack_entries * kStackEntryBytes;
  }
  int leaf_records() const { return leaf_triangles > kLightRun ? leaf_triangles : kLightRun; }
};

}  // namespace path_tracer
