#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "firmware/path_tracer/records/records.hpp"

/// The simulator's tree for machines that neither count nor time instructions: there brute force, which
/// charges the same whatever it finds, need not test every triangle. Hits have one order
/// (geometry/triangle.hpp), so a search that tests all triangles whose boxes a ray meets finds the same hit
/// to the bit.
namespace path_tracer {

/// Eight boxes in single precision, component by component, which contain the padded boxes of their triangles
/// (geometry/triangle_record.hpp) for certain.
struct alignas(64) SearchNode {
  static constexpr int kChildren = 8;
  float lower[3][kChildren];
  float upper[3][kChildren];
  /// A node, or from kFirstLeaf on: kFirstLeaf + its number among the leaves.
  std::uint32_t child[kChildren];
  std::uint32_t present = 0;  ///< bit i: child i exists
};

struct SearchLeaf {
  std::int32_t first = 0;  ///< in SearchTree::order
  std::int32_t count = 0;
};

struct SearchTree {
  static constexpr std::uint32_t kFirstLeaf = std::uint32_t{1} << 31;
  static constexpr int kMostInLeaf = 4;
  /// No way from the root passes more nodes.
  static constexpr int kMostLevels = 64;

  vec3<double> anchor{};
  double unit = 1;                ///< factor of coordinates, a power of two; no coordinate is above 2 units
  std::vector<SearchNode> nodes;  ///< the first one is the root; empty without triangles
  std::vector<SearchLeaf> leaves;
  std::vector<std::int32_t> order;  ///< indices of triangles, leaf by leaf

  bool empty() const { return nodes.empty(); }
};

/// @param reach no ray starts farther from a vertex, and no vertex is farther from another
SearchTree make_search_tree(const TriangleRecord* first, int count, double reach, const Layers& layers = {});

}  // namespace path_tracer
