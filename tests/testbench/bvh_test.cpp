#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "testbench/bvh/balanced_bvh.hpp"
#include "testbench/bvh/build_bvh.hpp"
#include "testbench/system/error.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/meshes.hpp"

namespace bvh_test {

using testbench::Box;
using testbench::build_balanced_bvh;
using testbench::build_bvh;
using testbench::Bvh;
using testbench::BvhChild;
using testbench::BvhNode;
using testbench::BvhOptions;
using testbench::Triangle;

enum class Split { by_area, by_number };

class BvhInvariants : public testing::TestWithParam<std::tuple<test_support::Mesh, int, int, Split>> {
 protected:
  std::vector<Triangle> triangles = test_support::mesh(std::get<0>(GetParam()));
  BvhOptions options{std::get<1>(GetParam()), std::get<2>(GetParam())};
  Bvh bvh = build();

  Bvh build() const {
    if (std::get<3>(GetParam()) == Split::by_area) return build_bvh(triangles, options);
    std::vector<Box> boxes;
    for (const Triangle& triangle : triangles) boxes.push_back(bounds_of(triangle));
    return build_balanced_bvh(boxes, options.width, options.max_leaf_triangles);
  }

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
  const Bvh again = build();
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
                                          testing::Values(1, 4),
                                          testing::Values(Split::by_area, Split::by_number)),
                         [](const auto& suite) {
                           return test_support::name_of(std::get<0>(suite.param)) + "_width" +
                                  std::to_string(std::get<1>(suite.param)) + "_leaf" +
                                  std::to_string(std::get<2>(suite.param)) +
                                  (std::get<3>(suite.param) == Split::by_area ? "" : "_balanced");
                         });

TEST(Bvh, NothingHasNoNodes) {
  const Bvh bvh = build_bvh(std::vector<Triangle>{}, {});
  EXPECT_TRUE(bvh.nodes.empty());
  EXPECT_TRUE(bvh.triangles.empty());
  EXPECT_EQ(sah_cost(bvh, {}), 0.0);
}

TEST(Bvh, OptionsOutOfRangeAreNamed) {
  const auto message = [](const BvhOptions& options) {
    return test_support::input_error_of(
        [&] { build_bvh(test_support::mesh(test_support::Mesh::one), options); });
  };
  EXPECT_EQ(message({1, 4}), "BVH: width is 1, allowed are 2 to 8");
  EXPECT_EQ(message({9, 4}), "BVH: width is 9, allowed are 2 to 8");
  EXPECT_EQ(message({4, 0}), "BVH: number of triangles a leaf is 0, allowed are 1 to 30");
  EXPECT_EQ(message({4, 31}), "BVH: number of triangles a leaf is 31, allowed are 1 to 30");
  EXPECT_EQ(message({4, 4, 15}), "BVH: depth is 15, allowed are 16 to 128");
  EXPECT_EQ(message({4, 4, 129}), "BVH: depth is 129, allowed are 16 to 128");
}

/// Embree exceeds the levels here, because binned splits separate one box at a time.
TEST(Bvh, TrianglesInOnePlaceAndFarAwayGiveABalancedTree) {
  std::vector<Box> boxes(200000, Box{glm::dvec3(0), glm::dvec3(1e-9)});
  for (int i = 0; i < 60; ++i)
    boxes.push_back({glm::dvec3(std::ldexp(1.0, i)), glm::dvec3(std::ldexp(1.5, i))});
  BvhOptions options;
  options.max_leaf_triangles = 1;
  options.max_depth = 21;
  const Bvh bvh = build_bvh(boxes, options);
  EXPECT_EQ(bvh.triangles.size(), boxes.size());
  EXPECT_LE(levels(bvh), options.max_depth);
}

TEST(Bvh, ABalancedTreeHasTheLeastLevels) {
  const std::vector<Box> boxes(1000, Box{glm::dvec3(0), glm::dvec3(1)});
  EXPECT_EQ(levels(build_balanced_bvh(boxes, 2, 1)), 10);
  EXPECT_EQ(levels(build_balanced_bvh(boxes, 4, 1)), 5);
  EXPECT_EQ(levels(build_balanced_bvh(boxes, 8, 2)), 3);
}

/// 2^17 boxes need 17 levels of nodes with two children.
TEST(Bvh, ThatIsTooDeepByAnyWayIsRefused) {
  const std::vector<Box> boxes(1u << 17, Box{glm::dvec3(0), glm::dvec3(1)});
  try {
    build_bvh(boxes, {2, 1, 16});
    FAIL() << "built";
  } catch (const testbench::RunError& error) {
    EXPECT_STREQ(error.what(), "BVH of 131072 triangles: 17 levels at least, allowed are 16");
  }
}

TEST(Bvh, ARayOfASoupIsExpectedToCostAHundredthOfBruteForce) {
  const auto triangles = test_support::soup(20000, 1.0, 0.01, 1);
  const BvhOptions options{4, 4};
  EXPECT_LT(sah_cost(build_bvh(triangles, options), options), 0.01 * double(triangles.size()));
}

}  // namespace bvh_test
