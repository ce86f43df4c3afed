#include "testbench/bvh/tree_image.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>

#include "testbench/bvh/node_format.hpp"
#include "tests/support/meshes.hpp"
#include "tests/support/node_layouts.hpp"

namespace tree_image_test {

using path_tracer::ChildReference;
using path_tracer::max_tree_levels;
using path_tracer::TreeShape;
using testbench::Box;
using testbench::make_tree_image;
using testbench::TreeImage;

std::vector<Box> boxes_of(const std::vector<testbench::Triangle>& triangles) {
  std::vector<Box> boxes;
  for (const testbench::Triangle& triangle : triangles) boxes.push_back(bounds_of(triangle));
  return boxes;
}

Box point(double x, double y, double z) {
  Box box;
  box.include(glm::dvec3(x, y, z));
  return box;
}

class TreeImageOf : public testing::TestWithParam<test_support::Mesh> {};

/// From slot 0 every triangle is reached once, in a box that contains its own, within the stated number of
/// levels.
TEST_P(TreeImageOf, LeadsToEveryTriangleInsideItsBoxes) {
  for (const path_tracer::NodeLayout& layout : test_support::node_layouts()) {
    const std::vector<Box> boxes =
        boxes_of(test_support::in_nodes_unit(test_support::mesh(GetParam()), layout.format));
    const TreeShape shape{layout, 5, 3, 2, 8};
    const TreeImage image = make_tree_image(boxes, shape);
    const int node_bytes = shape.layout.node_bytes();
    ASSERT_EQ(image.nodes.size(), std::size_t(image.slots) * std::size_t(node_bytes));
    ASSERT_EQ((image.slots - shape.resident_nodes) % shape.treelet_nodes, 0);
    std::vector<int> met(boxes.size(), 0);
    int deepest = 0;
    struct Place {
      std::int32_t slot;
      int level;
    };
    std::vector<Place> open{{0, 1}};
    while (!open.empty()) {
      const Place place = open.back();
      open.pop_back();
      deepest = std::max(deepest, place.level);
      const std::uint8_t* const node = image.nodes.data() + place.slot * node_bytes;
      for (int i = 0; i < shape.layout.width; ++i) {
        const ChildReference child = testbench::decode_reference(node, shape.layout, i);
        const Box box = testbench::decode_box(node, shape.layout, i);
        if (child.count == 0) open.push_back({child.first, place.level + 1});
        ASSERT_LE(child.count, shape.leaf_triangles);
        for (int t = 0; t < child.count; ++t) {
          const auto triangle = std::size_t(image.triangles.at(std::size_t(child.first + t)));
          ++met.at(triangle);
          EXPECT_TRUE(box.contains(boxes[triangle]));
        }
      }
    }
    EXPECT_EQ(std::count(met.begin(), met.end(), 1), std::ptrdiff_t(met.size()));
    EXPECT_EQ(deepest, image.levels);
    EXPECT_LE(image.levels, max_tree_levels(layout.width));
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, TreeImageOf, testing::ValuesIn(test_support::kMeshes),
                         [](const auto& suite) { return test_support::name_of(suite.param); });

TEST(TreeImage, OfNothingIsARootThatLeadsNowhere) {
  const TreeShape shape;
  const TreeImage image = make_tree_image({}, shape);
  EXPECT_TRUE(image.triangles.empty());
  EXPECT_EQ(image.slots, shape.resident_nodes);
  for (int i = 0; i < shape.layout.width; ++i)
    EXPECT_EQ(testbench::decode_reference(image.nodes.data(), shape.layout, i).count,
              ChildReference::kNowhere);
}

/// One clump, and points on each axis, each 1/40 as far out as the one before. The heuristic separates only a
/// few of them on each level.
std::vector<Box> clump_and_outliers(int clump) {
  std::vector<Box> boxes(std::size_t(clump), point(0, 0, 0));
  double distance = 1.0;
  for (int i = 0; i < 25; ++i, distance /= 40) {
    boxes.push_back(point(distance, 0, 0));
    boxes.push_back(point(0, distance, 0));
    boxes.push_back(point(0, 0, distance));
  }
  return boxes;
}

TEST(TreeImage, KeepsToTheLevelsThatARayCanFollow) {
  for (const int width : {4, 8}) {
    TreeShape shape;
    shape.layout.width = width;
    shape.leaf_triangles = 1;
    const TreeImage image = make_tree_image(clump_and_outliers(60000), shape);
    EXPECT_GT(image.levels, max_tree_levels(width) - 4) << "a scene that is no challenge to width " << width;
    EXPECT_LE(image.levels, max_tree_levels(width));
  }
}

/// With ten times as many boxes, or with two children per node, the heuristic's tree would be too deep.
TEST(TreeImage, IsBalancedWhereItWouldBeTooDeep) {
  const std::vector<Box> boxes = clump_and_outliers(600000);
  for (const auto& [width, levels] : std::map<int, int>{{2, 20}, {4, 10}}) {
    TreeShape shape;
    shape.layout.width = width;
    shape.leaf_triangles = 1;
    const TreeImage image = make_tree_image(boxes, shape);
    EXPECT_EQ(image.triangles.size(), boxes.size());
    EXPECT_LE(image.levels, levels);  // the smallest number of levels that can hold all boxes
  }
}

}  // namespace tree_image_test
