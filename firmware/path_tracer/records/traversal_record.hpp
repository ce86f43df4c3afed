#pragma once

#include "firmware/path_tracer/records/node_layout.hpp"
#include "firmware/path_tracer/records/records.hpp"

namespace path_tracer {

/// TraversalRecord::node when it is no slot.
inline constexpr std::int32_t kNextOnStack = -1;
inline constexpr std::int32_t kTraversalOver = -2;

/// No slot is in a treelet that begins here.
inline constexpr std::int32_t kNoTreelet = 1 << 30;

/// A ray on its way through the tree, in the traversal bin: what it found so far and where it goes on. Behind
/// it lie the entries of its short stack, 8 bytes each.
///
/// Children of a node are visited in the order of their entries. `trail` counts for each level how many the
/// path from the root has left behind, as many bits a level as that takes, and `more` has a bit for each
/// level with siblings still to come. The short stack holds the latest of those; when it has lost the older
/// ones, the ray starts again at the root and follows the trail (Laine, "Restart Trail for Stackless BVH
/// Traversal", HPG 2010; Vaidyanathan, Woop, Benthin, "Wide BVH Traversal with a Short Stack", HPG 2019). So
/// no depth and no stack loses a hit.
struct TraversalRecord {
  vec3<double> origin{};
  vec3<double> direction{};
  double distance = 0;  ///< of the nearest hit, scaled by |determinant|
  double determinant = 0;
  std::uint64_t trail = 0;
  std::int32_t number = -1;  ///< of the nearest triangle
  std::int32_t left_face = kNoFace;
  /// Of a shadow ray whose light it has hit or is about to test: anything nearer ends it.
  std::int32_t light_face = kNoFace;
  std::int32_t slot = 0;        ///< of the ray bin
  std::int32_t node = 0;        ///< to visit next: a slot of the tree, kNextOnStack or kTraversalOver
  std::int32_t level = 0;       ///< of that node, 0 is the root's
  std::int32_t leaf = 0;        ///< to test before: its first triangle
  std::int32_t leaf_count = 0;  ///< and how many there are
  std::uint32_t more = 0;
  std::int32_t stack = 0;  ///< place of the next entry, 16 bits, and above that how many there are
};

/// An entry of the short stack: where its box is entered (node_ray.hpp), and the reference of the child,
/// flagged when it is the last of its siblings.
inline constexpr int kStackEntryBytes = 8;

/// Bits of the trail for a level, which counts from 0 to the width.
constexpr int trail_bits(int width) {
  int bits = 1;
  while (width >> bits > 0) ++bits;
  return bits;
}
/// That the trail has room for: 32, 21 or 16.
constexpr int max_tree_levels(int width) {
  return 64 / trail_bits(width);
}

inline constexpr int kMaxStackEntries = 32;
inline constexpr int kMaxLeafTriangles = 8;
inline constexpr int kMaxVisits = 1024;
inline constexpr int kMaxTreeletNodes = 1024;  ///< far beyond what a PE's SRAM holds

/// The last records of the triangle array: each light's own triangles once more, so many a light, for shadow
/// rays to begin with.
inline constexpr int kLightRun = 2;

/// The tree as kernels see it.
struct TreeShape {
  NodeLayout layout;
  int resident_nodes = 8;  ///< slots [0, resident_nodes) stay in every PE's SRAM
  int treelet_nodes = 2;   ///< further slots are loaded so many at a time
  int leaf_triangles = 2;  ///< at most
  int stack_entries = 8;   ///< a power of two, or 0
  /// Nodes that a ray visits in a turn, at most; 0: as many as are in SRAM. The PEs take the steps of the one
  /// that has the most, so a ray that has many does better to go on in the next turn, with others that have.
  int visits = 4;

  int resident_bytes() const { return resident_nodes * layout.node_bytes(); }
  int treelet_bytes() const { return treelet_nodes * layout.node_bytes(); }
  int record_bytes() const {
    return static_cast<int>(sizeof(TraversalRecord)) + stack_entries * kStackEntryBytes;
  }
  int leaf_records() const { return leaf_triangles > kLightRun ? leaf_triangles : kLightRun; }
};

}  // namespace path_tracer
