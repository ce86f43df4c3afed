#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/path_tracer/prefilter/prefilter.hpp"

/// The simulator's tree for machines that neither count nor time instructions: there brute force, which
/// charges the same whatever it finds, need not test every triangle. Hits have one order
/// (geometry/triangle.hpp). So a search finds the same hit to the bit if it tests each triangle that the ray
/// may cross and that no certain crossing is before.
namespace path_tracer {

/// Eight boxes in single precision, component by component, which contain the padded boxes of their triangles
/// (geometry/triangle_record.hpp) for certain. A child that does not exist has a box that no ray meets.
struct alignas(64) SearchNode {
  static constexpr int kChildren = 8;
  float plane[2][3][kChildren];  ///< lower and upper ones, of each axis
  /// A node, or from SearchTree::kFirstLeaf on: kFirstLeaf + its number among the leaves.
  std::uint32_t child[kChildren];
};

/// Up to eight triangles in single precision, component by component, as PrefilterTriangles are.
struct alignas(64) SearchLeaf {
  static constexpr int kTriangles = 8;
  float vertex[3][kTriangles];
  float minus_edge1[3][kTriangles];
  float edge2[3][kTriangles];
  float back[3][kTriangles];
  /// A crossing whose determinant's size is at least this times the sum of the direction's components lies in
  /// the triangle's padded box for certain.
  float certain_determinant[kTriangles];
  std::int32_t face[kTriangles];
  std::int32_t index[kTriangles];  ///< among the scene's triangles
  std::int32_t count = 0;
};

/// A triangle so large that most rays meet its box, such as a part of a wall.
struct LargeTriangle {
  PrefilterTriangle triangle;
  float certain_determinant;  ///< as of SearchLeaf
  std::int32_t index;         ///< likewise
};

struct SearchTree {
  static constexpr std::uint32_t kFirstLeaf = std::uint32_t{1} << 31;
  /// No way from the root passes more nodes.
  static constexpr int kMostLevels = 64;
  static constexpr std::int32_t kNoLeaf = -1;
  static constexpr int kMostLarge = 32;

  vec3<double> anchor{};
  double unit = 1;  ///< factor of coordinates, a power of two; no coordinate is above 2 units
  /// A strip's rays are tested with each of them; the tree is of the others.
  std::vector<LargeTriangle> large;
  std::vector<SearchNode> nodes;  ///< the first one is the root
  std::vector<SearchLeaf> leaves;
  /// For each face the leaf, beside those of the tree, that holds all triangles of a light's face. kNoLeaf
  /// for other faces, and for those of more triangles.
  std::vector<std::int32_t> light_leaf;

  bool empty() const { return nodes.empty(); }  ///< of a scene without triangles, or not made yet
};

/// @param reach no ray starts farther from a vertex, and no vertex is farther from another
/// @param lights whose faces end searches for shadow rays early
SearchTree make_search_tree(const TriangleRecord* first, int count, double reach, const Layers& layers = {},
                            const LightRecord* lights = nullptr, int light_count = 0);

}  // namespace path_tracer
