#include "testbench/bvh/treelets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "testbench/bvh/build_bvh.hpp"
#include "testbench/bvh/node_format.hpp"
#include "tests/support/meshes.hpp"

namespace {

using path_tracer::NodeFormat;
using path_tracer::NodeLayout;
using testbench::build_bvh;
using testbench::Bvh;
using testbench::BvhNode;
using testbench::decode_reference;
using testbench::encode_treelets;
using testbench::pack_treelets;
using testbench::Treelets;

class TreeletsOf : public testing::TestWithParam<std::tuple<test_support::Mesh, int>> {
 protected:
  Bvh bvh = build_bvh(test_support::mesh(std::get<0>(GetParam())), {4, 2});
  int nodes_per_treelet = std::get<1>(GetParam());
  Treelets treelets = pack_treelets(bvh, nodes_per_treelet);
};

TEST_P(TreeletsOf, HaveASlotForEachNodeAndTheRootFirst) {
  const std::set<std::int32_t> slots(treelets.slot_of_node.begin(), treelets.slot_of_node.end());
  EXPECT_EQ(slots.size(), bvh.nodes.size());
  EXPECT_EQ(*slots.begin(), 0);
  EXPECT_LT(*slots.rbegin(), treelets.count * nodes_per_treelet);
  EXPECT_EQ(treelets.slot_of_node[0], 0);
}

/// Two treelets that are less than half full would fit one.
TEST_P(TreeletsOf, AreFilled) {
  std::vector<int> nodes(std::size_t(treelets.count), 0);
  for (std::int32_t node = 0; node < std::int32_t(bvh.nodes.size()); ++node)
    ++nodes[std::size_t(treelets.treelet_of_node(node))];
  EXPECT_GE(*std::min_element(nodes.begin(), nodes.end()), 1);
  EXPECT_LE(std::count_if(nodes.begin(), nodes.end(), [&](int n) { return 2 * n < nodes_per_treelet; }), 1);
}

/// Walks the encoded tree from slot 0.
TEST_P(TreeletsOf, LeadFromTheRootToEveryTriangle) {
  const NodeLayout layout{NodeFormat::fp32, 4};
  const auto bytes = encode_treelets(bvh, treelets, layout);
  ASSERT_EQ(bytes.size(), std::size_t(treelets.count * nodes_per_treelet * layout.node_bytes()));
  std::vector<int> met(bvh.triangles.size(), 0);
  std::vector<std::int32_t> slots{0};
  while (!slots.empty()) {
    const std::uint8_t* const node = bytes.data() + slots.back() * layout.node_bytes();
    slots.pop_back();
    for (int i = 0; i < layout.width; ++i) {
      const auto child = decode_reference(node, layout, i);
      if (child.count == 0) slots.push_back(child.first);
      for (int t = 0; t < child.count; ++t) ++met.at(std::size_t(child.first + t));
    }
  }
  EXPECT_EQ(std::count(met.begin(), met.end(), 1), std::ptrdiff_t(met.size()));
}

INSTANTIATE_TEST_SUITE_P(Meshes, TreeletsOf,
                         testing::Combine(testing::ValuesIn(test_support::kMeshes),
                                          testing::Values(1, 7, 40)),
                         [](const auto& suite) {
                           return test_support::name_of(std::get<0>(suite.param)) + "_of" +
                                  std::to_string(std::get<1>(suite.param));
                         });

/// A path from the root downwards changes treelets less often than it changes nodes.
TEST(Treelets, KeepParentsAndChildrenTogether) {
  const Bvh bvh = build_bvh(test_support::mesh(test_support::Mesh::soup), {4, 2});
  const Treelets treelets = pack_treelets(bvh, 21);  // 1 + 4 + 16
  int inside = 0;
  int edges = 0;
  for (std::int32_t n = 0; n < std::int32_t(bvh.nodes.size()); ++n)
    for (int i = 0; i < bvh.nodes[std::size_t(n)].child_count; ++i) {
      const auto& child = bvh.nodes[std::size_t(n)].child[std::size_t(i)];
      if (child.is_leaf()) continue;
      ++edges;
      inside += treelets.treelet_of_node(n) == treelets.treelet_of_node(child.node);
    }
  EXPECT_GT(inside, edges / 2);
}

TEST(Treelets, OfNoNodesAreNone) {
  EXPECT_EQ(pack_treelets(Bvh{}, 8).count, 0);
}

}  // namespace
