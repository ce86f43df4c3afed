#include "testbench/bvh/treelets.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "testbench/bvh/build_bvh.hpp"
#include "testbench/bvh/node_format.hpp"
#include "tests/support/meshes.hpp"

namespace treelets_test {

using path_tracer::NodeFormat;
using path_tracer::NodeLayout;
using testbench::build_bvh;
using testbench::Bvh;
using testbench::BvhNode;
using testbench::decode_reference;
using testbench::encode_treelets;
using testbench::pack_treelets;
using testbench::Treelets;
using testbench::TreeletSizes;

class TreeletsOf : public testing::TestWithParam<std::tuple<test_support::Mesh, TreeletSizes>> {
 protected:
  Bvh bvh = build_bvh(test_support::mesh(std::get<0>(GetParam())), {4, 2});
  TreeletSizes sizes = std::get<1>(GetParam());
  Treelets treelets = pack_treelets(bvh, sizes);
};

TEST_P(TreeletsOf, HaveASlotForEachNodeAndTheRootFirst) {
  const std::set<std::int32_t> slots(treelets.slot_of_node.begin(), treelets.slot_of_node.end());
  EXPECT_EQ(slots.size(), bvh.nodes.size());
  EXPECT_EQ(*slots.begin(), 0);
  EXPECT_LT(*slots.rbegin(), treelets.slots());
  EXPECT_EQ(treelets.slots(), sizes.resident + treelets.count * sizes.per_treelet);
  EXPECT_EQ(treelets.slot_of_node[0], 0);
}

/// Two treelets that are less than half full would fit into one.
TEST_P(TreeletsOf, AreFilled) {
  std::vector<int> nodes(std::size_t(treelets.count), 0);
  int resident = 0;
  for (std::int32_t node = 0; node < std::int32_t(bvh.nodes.size()); ++node) {
    const std::int32_t treelet = treelets.treelet_of_node(node);
    ++(treelet < 0 ? resident : nodes[std::size_t(treelet)]);
  }
  EXPECT_EQ(resident, std::min(sizes.resident, int(bvh.nodes.size())));
  EXPECT_EQ(std::count(nodes.begin(), nodes.end(), 0), 0);
  EXPECT_LE(std::count_if(nodes.begin(), nodes.end(), [&](int n) { return 2 * n < sizes.per_treelet; }), 1);
}

/// Rays visit the resident nodes first, so the parent of a resident node is resident.
TEST_P(TreeletsOf, ResidentNodesHangTogether) {
  for (std::int32_t n = 0; n < std::int32_t(bvh.nodes.size()); ++n)
    for (int i = 0; i < bvh.nodes[std::size_t(n)].child_count; ++i) {
      const auto& child = bvh.nodes[std::size_t(n)].child[std::size_t(i)];
      if (!child.is_leaf() && treelets.treelet_of_node(child.node) < 0) {
        EXPECT_LT(treelets.treelet_of_node(n), 0);
      }
    }
}

/// Visits the encoded tree from slot 0.
TEST_P(TreeletsOf, LeadFromTheRootToEveryTriangle) {
  const NodeLayout layout{NodeFormat::fp32, 4};
  const auto bytes = encode_treelets(bvh, treelets, layout);
  ASSERT_EQ(bytes.size(), std::size_t(treelets.slots() * layout.node_bytes()));
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
                                          testing::Values(TreeletSizes{1, 1}, TreeletSizes{1, 40},
                                                          TreeletSizes{7, 7}, TreeletSizes{40, 1})),
                         [](const auto& suite) {
                           const TreeletSizes sizes = std::get<1>(suite.param);
                           return test_support::name_of(std::get<0>(suite.param)) + "_resident" +
                                  std::to_string(sizes.resident) + "_of" + std::to_string(sizes.per_treelet);
                         });

/// A path from the root downwards changes treelets less often than it changes nodes.
TEST(Treelets, KeepParentsAndChildrenTogether) {
  const Bvh bvh = build_bvh(test_support::mesh(test_support::Mesh::soup), {4, 2});
  const Treelets treelets = pack_treelets(bvh, {21, 21});  // 1 + 4 + 16
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

TEST(Treelets, OfNoNodesAreOneNodeThatLeadsNowhere) {
  const NodeLayout layout{NodeFormat::fp32, 4};
  const Treelets treelets = pack_treelets(Bvh{}, {3, 8});
  EXPECT_EQ(treelets.count, 0);
  const auto bytes = encode_treelets(Bvh{}, treelets, layout);
  ASSERT_EQ(bytes.size(), std::size_t(3 * layout.node_bytes()));
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(decode_reference(bytes.data(), layout, i).count, path_tracer::ChildReference::kNowhere);
}

}  // namespace treelets_test
