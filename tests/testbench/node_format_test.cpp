#include "testbench/bvh/node_format.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/bvh/build_bvh.hpp"
#include "tests/support/meshes.hpp"

namespace node_format_test {

using path_tracer::NodeFormat;
using path_tracer::NodeLayout;
using testbench::Box;
using testbench::build_bvh;
using testbench::BvhNode;
using testbench::decode_box;
using testbench::decode_reference;
using testbench::encode_node;

constexpr NodeFormat kFormats[] = {NodeFormat::fp64, NodeFormat::fp32, NodeFormat::quantised8};

std::vector<std::uint8_t> encode(const BvhNode& node, const NodeLayout& layout) {
  std::vector<std::uint8_t> bytes(std::size_t(layout.node_bytes()), 0xee);
  encode_node(node, layout, {}, bytes.data());
  return bytes;
}

class NodeFormats : public testing::TestWithParam<std::tuple<NodeFormat, int>> {
 protected:
  NodeLayout layout{std::get<0>(GetParam()), std::get<1>(GetParam())};

  void expect_conservative(const BvhNode& node) const {
    const auto bytes = encode(node, layout);
    for (int i = 0; i < node.child_count; ++i)
      EXPECT_TRUE(decode_box(bytes.data(), layout, i).contains(node.child[std::size_t(i)].box)) << i;
  }
};

/// Random boxes of every magnitude, some of them flat. Quantised boxes are in the unit of nodes, where the
/// largest coordinates are as far from the reach as doubles can be.
TEST_P(NodeFormats, NeverShrinkABox) {
  std::mt19937_64 random(1);
  const double largest = layout.format == NodeFormat::quantised8 ? 16.0 : 307.0;
  std::uniform_real_distribution<double> exponent(-320.0, largest);
  std::uniform_real_distribution<double> mantissa(-1.0, 1.0);
  for (int round = 0; round < 20000; ++round) {
    BvhNode node;
    node.child_count = layout.width;
    const double scale = std::pow(10.0, exponent(random));
    const double shift = std::pow(10.0, exponent(random)) * mantissa(random);
    for (int i = 0; i < node.child_count; ++i)
      for (int point = 0; point < 1 + round % 2; ++point)
        node.child[std::size_t(i)].box.include(
            glm::dvec3(mantissa(random), mantissa(random), round % 3 == 0 ? 0.0 : mantissa(random)) * scale +
            shift);
    expect_conservative(node);
    if (HasFailure()) return;
  }
}

TEST_P(NodeFormats, KeepTheBoxesOfEveryMesh) {
  for (const test_support::Mesh mesh : test_support::kMeshes) {
    const auto bvh =
        build_bvh(test_support::in_nodes_unit(test_support::mesh(mesh), layout.format), {layout.width, 2});
    for (BvhNode node : bvh.nodes) {
      for (int i = 0; i < node.child_count; ++i) node.child[std::size_t(i)].node = -1;
      expect_conservative(node);
    }
    if (HasFailure()) FAIL() << test_support::name_of(mesh);
  }
}

/// A stored box exceeds the exact one on each side by at most one ulp of fp32, or by one of 255 steps, which
/// are at most twice as long as necessary.
TEST_P(NodeFormats, GrowABoxByAStepAtMost) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int round = 0; round < 2000; ++round) {
    BvhNode node;
    node.child_count = layout.width;
    for (int i = 0; i < node.child_count; ++i)
      for (int point = 0; point < 2; ++point)
        node.child[std::size_t(i)].box.include(glm::dvec3(number(random), number(random), number(random)));
    const double step = layout.format == NodeFormat::fp64   ? 0.0
                        : layout.format == NodeFormat::fp32 ? 0x1p-24
                                                            : 2.0 * 2.0 / 255 + 0x1p-23;
    const auto bytes = encode(node, layout);
    for (int i = 0; i < node.child_count; ++i) {
      const Box& box = node.child[std::size_t(i)].box;
      const Box stored = decode_box(bytes.data(), layout, i);
      for (int axis = 0; axis < 3; ++axis) {
        EXPECT_LE(box.lower[axis] - stored.lower[axis], step);
        EXPECT_LE(stored.upper[axis] - box.upper[axis], step);
      }
    }
    if (HasFailure()) return;
  }
}

TEST_P(NodeFormats, TellWhereChildrenLead) {
  BvhNode node;
  node.child_count = 2;
  node.child[0].box.include(glm::dvec3(0.0));
  node.child[0].node = 3;
  node.child[1].box.include(glm::dvec3(1.0));
  node.child[1].first_triangle = 17;
  node.child[1].triangle_count = 4;
  std::vector<std::uint8_t> bytes(std::size_t(layout.node_bytes()));
  encode_node(node, layout, {0, 10, 20, 30}, bytes.data());
  const auto inner = decode_reference(bytes.data(), layout, 0);
  EXPECT_EQ(inner.first, 30);
  EXPECT_EQ(inner.count, 0);
  const auto leaf = decode_reference(bytes.data(), layout, 1);
  EXPECT_EQ(leaf.first, 17);
  EXPECT_EQ(leaf.count, 4);
  for (int i = 2; i < layout.width; ++i)
    EXPECT_EQ(decode_reference(bytes.data(), layout, i).count, path_tracer::ChildReference::kNowhere);
}

TEST_P(NodeFormats, AreWholeWords) {
  EXPECT_EQ(layout.node_bytes() % 8, 0);
  EXPECT_EQ(layout.reference_offset(0) % 8, 0);
}

INSTANTIATE_TEST_SUITE_P(Formats, NodeFormats,
                         testing::Combine(testing::ValuesIn(kFormats), testing::Values(2, 4, 8)),
                         [](const auto& suite) {
                           return std::string(path_tracer::name_of(std::get<0>(suite.param))) + "_width" +
                                  std::to_string(std::get<1>(suite.param));
                         });

TEST(NodeLayout, SizesOfANode) {
  EXPECT_EQ((NodeLayout{NodeFormat::fp64, 4}.node_bytes()), 4 * (48 + 4));
  EXPECT_EQ((NodeLayout{NodeFormat::fp32, 4}.node_bytes()), 4 * (24 + 4));
  EXPECT_EQ((NodeLayout{NodeFormat::quantised8, 4}.node_bytes()), 16 + 4 * (6 + 4));
  EXPECT_EQ((NodeLayout{NodeFormat::quantised8, 2}.node_bytes()), 16 + 16 + 2 * 4);
}

}  // namespace node_format_test
