#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "testbench/bvh/build_bvh.hpp"
#include "testbench/error.hpp"
#include "tests/support/meshes.hpp"

namespace {

using testbench::Box;
using testbench::build_bvh;
using testbench::Bvh;
using testbench::BvhChild;
using testbench::BvhNode;
using testbench::BvhOptions;
using testbench::Triangle;

class BvhInvariants : public testing::TestWithParam<std::tuple<test_support::Mesh, int, int>> {
 protected:
  std::vector<Triangle> triangles = test_support::mesh(std::get<0>(GetParam()));
  BvhOptions options{std::get<1>(GetParam()), std::get<2>(GetParam())};
  Bvh bvh = build_bvh(triangles, options);

  Box box_below(const BvhChild& child) const {
    Box box;
    if (child.is_leaf()) {
      for (int i = 0; i < child.triangle_count; ++i)
        box.include(bounds_of(triangles[std::size_t(bvh.triangles[std::size_t(child.first_triangle + i)])]));
    } else {
      const BvhNode& node = bvh.nodes[std::size_t(child.node)];
      for (int i = 0; i < node.child_count; ++i) box.include(node.child[std::size_t(i)].box);
    }
    return box;
  }
};

TEST_P(BvhInvariants, EveryTriangleIsInOneLeaf) {
  std::vector<std::int32_t> sorted = bvh.triangles;
  std::sort(sorted.begin(), sorted.end());
  ASSERT_EQ(sorted.size(), triangles.size());
  for (std::size_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], std::int32_t(i));
  std::int32_t next = 0;
  for (const BvhNode& node : bvh.nodes)
    for (int i = 0; i < node.child_count; ++i)
      if (node.child[std::size_t(i)].is_leaf()) next += node.child[std::size_t(i)].triangle_count;
  EXPECT_EQ(next, std::int32_t(triangles.size()));
}

TEST_P(BvhInvariants, EveryNodeHasOneParentThatStandsBeforeIt) {
  std::vector<int> parents(bvh.nodes.size(), 0);
  for (std::size_t n = 0; n < bvh.nodes.size(); ++n)
    for (int i = 0; i < bvh.nodes[n].child_count; ++i) {
      const BvhChild& child = bvh.nodes[n].child[std::size_t(i)];
      if (child.is_leaf()) continue;
      ASSERT_GT(std::size_t(child.node), n);
      ++parents.at(std::size_t(child.node));
    }
  for (std::size_t n = 0; n < bvh.nodes.size(); ++n) EXPECT_EQ(parents[n], n == 0 ? 0 : 1);
}

TEST_P(BvhInvariants, BoxesAreTheSmallestThatContainWhatIsBelow) {
  for (const BvhNode& node : bvh.nodes)
    for (int i = 0; i < node.child_count; ++i) {
      const BvhChild& child = node.child[std::size_t(i)];
      const Box box = box_below(child);
      EXPECT_EQ(child.box.lower, box.lower);
      EXPECT_EQ(child.box.upper, box.upper);
    }
}

TEST_P(BvhInvariants, NodesAndLeavesKeepTheirSizes) {
  for (const BvhNode& node : bvh.nodes) {
    EXPECT_GE(node.child_count, triangles.size() <= std::size_t(options.max_leaf_triangles) ? 1 : 2);
    EXPECT_LE(node.child_count, options.width);
    for (int i = 0; i < node.child_count; ++i) {
      if (!node.child[std::size_t(i)].is_leaf()) continue;
      EXPECT_GE(node.child[std::size_t(i)].triangle_count, 1);
      EXPECT_LE(node.child[std::size_t(i)].triangle_count, options.max_leaf_triangles);
    }
  }
}

TEST_P(BvhInvariants, TheSameTrianglesGiveTheSameTree) {
  const Bvh again = build_bvh(triangles, options);
  ASSERT_EQ(again.triangles, bvh.triangles);
  ASSERT_EQ(again.nodes.size(), bvh.nodes.size());
  for (std::size_t n = 0; n < bvh.nodes.size(); ++n) {
    ASSERT_EQ(again.nodes[n].child_count, bvh.nodes[n].child_count);
    for (int i = 0; i < bvh.nodes[n].child_count; ++i)
      EXPECT_EQ(again.nodes[n].child[std::size_t(i)].node, bvh.nodes[n].child[std::size_t(i)].node);
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, BvhInvariants,
                         testing::Combine(testing::ValuesIn(test_support::kMeshes), testing::Values(2, 4, 8),
                                          testing::Values(1, 4)),
                         [](const auto& suite) {
                           return test_support::name_of(std::get<0>(suite.param)) + "_width" +
                                  std::to_string(std::get<1>(suite.param)) + "_leaf" +
                                  std::to_string(std::get<2>(suite.param));
                         });

TEST(Bvh, NothingHasNoNodes) {
  const Bvh bvh = build_bvh(std::vector<Triangle>{}, {});
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_TRUE(bvh.triangles.empty());
  EXPECT_EQ(sah_cost(bvh, {}), 0.0);
}

TEST(Bvh, OptionsOutOfRangeAreNamed) {
  const auto message = [](const BvhOptions& options) {
    try {
      build_bvh(test_support::mesh(test_support::Mesh::one), options);
    } catch (const testbench::InputError& error) {
      return std::string(error.what());
    }
    return std::string("built");
  };
  EXPECT_EQ(message({1, 4}), "BVH: width is 1, allowed are 2 to 8");
  EXPECT_EQ(message({9, 4}), "BVH: width is 9, allowed are 2 to 8");
  EXPECT_EQ(message({4, 0}), "BVH: number of triangles a leaf is 0, allowed are 1 to 30");
  EXPECT_EQ(message({4, 31}), "BVH: number of triangles a leaf is 31, allowed are 1 to 30");
  EXPECT_EQ(message({4, 4, 15}), "BVH: depth is 15, allowed are 16 to 128");
  EXPECT_EQ(message({4, 4, 129}), "BVH: depth is 129, allowed are 16 to 128");
}

TEST(Bvh, ARayOfASoupIsExpectedToCostAHundredthOfBruteForce) {
  const auto triangles = test_support::soup(20000, 1.0, 0.01, 1);
  const BvhOptions options{4, 4};
  EXPECT_LT(sah_cost(build_bvh(triangles, options), options), 0.01 * double(triangles.size()));
}

}  // namespace
