#include "firmware/path_tracer/tree/mono_node.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "testbench/bvh/node_format.hpp"
#include "testbench/machine/native_machine.hpp"
#include "tests/support/node_layouts.hpp"

namespace mono_node_test {

using path_tracer::NodeLayout;
using testbench::Box;
using testbench::BvhNode;
using testbench::decode_box;
using testbench::decode_reference;

class MonoNodes : public testing::TestWithParam<NodeLayout> {};

BvhNode random_node(std::mt19937_64& random, int children) {
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const double scale = std::pow(10.0, 30.0 * number(random));
  BvhNode node;
  node.child_count = children;
  for (int i = 0; i < children; ++i) {
    for (int point = 0; point < 2; ++point)
      node.child[std::size_t(i)].box.include(glm::dvec3(number(random), number(random), number(random)) *
                                             scale);
    node.child[std::size_t(i)].first_triangle = std::int32_t(random() % 1000);
    node.child[std::size_t(i)].triangle_count = 1 + std::int32_t(random() % 8);
  }
  return node;
}

/// A packet must meet the boxes that a single ray would.
TEST_P(MonoNodes, AreWhatTheHostDecodes) {
  const NodeLayout layout = GetParam();
  const auto node_bytes = std::size_t(layout.node_bytes());
  constexpr int kNodes = 500;
  constexpr double kUnit = 0.25;
  testbench::NativeMachine machine(8, 1024, kNodes * node_bytes);
  std::mt19937_64 random(3);
  for (int slot = 0; slot < kNodes; ++slot) {
    const int children = slot % (layout.width + 1);
    encode_node(random_node(random, children), layout, {}, machine.mono() + std::size_t(slot) * node_bytes);
  }
  for (int slot = 0; slot < kNodes; ++slot) {
    const auto node = path_tracer::read_node(machine, {{0}, layout, kUnit}, slot);
    const std::uint8_t* const encoded = machine.mono() + std::size_t(slot) * node_bytes;
    ASSERT_EQ(node.children, slot % (layout.width + 1));
    for (int child = 0; child < node.children; ++child) {
      const Box box = decode_box(encoded, layout, child);
      for (int axis = 0; axis < 3; ++axis) {
        const auto& four = node.four[child / 4];
        EXPECT_EQ(four.lower[axis][std::size_t(child % 4)], kUnit * box.lower[axis]);
        EXPECT_EQ(four.upper[axis][std::size_t(child % 4)], kUnit * box.upper[axis]);
      }
      const auto expected = decode_reference(encoded, layout, child);
      const auto found = path_tracer::PackedReference::unpack(node.reference[child]);
      EXPECT_EQ(found.first, expected.first);
      EXPECT_EQ(found.count, expected.count);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Layouts, MonoNodes, testing::ValuesIn(test_support::node_layouts()));

}  // namespace mono_node_test
