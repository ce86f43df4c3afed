#include "firmware/path_tracer/tree/mono_node.hpp"

#include <cmath>
#include <cstring>

#include "firmware/cn/machine.hpp"

namespace path_tracer {
namespace {

// Instructions of the control unit (assumed). The kernel charges the loads of its operands, so these are what
// lies between: a number of 4 bytes is converted and multiplied; one of 8 bits is converted, multiplied,
// added to and multiplied; a power of two is made from its exponent in three instructions.
constexpr std::uint64_t kNodeInstructions = 6;  // its address, the references

template <class T>
T load(const unsigned char* node, int offset) {
  T value;
  std::memcpy(&value, node + offset, sizeof(value));
  return value;
}

std::uint64_t decoding_instructions(const NodeLayout& layout) {
  const auto coordinates = std::uint64_t(2 * kAxes * layout.width);
  if (layout.format == NodeFormat::fp64) return kNodeInstructions;
  return kNodeInstructions +
         (layout.format == NodeFormat::fp32 ? 2 * coordinates : 4 * coordinates + 3 * kAxes);
}

double coordinate(const unsigned char* node, const NodeLayout& layout, int component, int child) {
  const int offset = layout.coordinate_offset(component, child);
  if (layout.format == NodeFormat::fp64) return load<double>(node, offset);
  if (layout.format == NodeFormat::fp32) return double(load<float>(node, offset));
  const auto frame = load<QuantisedFrame>(node, 0);
  const int axis = component % kAxes;
  return double(quantised_coordinate(frame, axis, load<std::uint8_t>(node, offset)));
}

}  // namespace

MonoNode read_node(cn::Machine& machine, const MonoNodes& nodes, std::int32_t slot) {
  const NodeLayout& layout = nodes.layout;
  const auto words = static_cast<std::size_t>(layout.node_bytes()) / sizeof(std::uint64_t);
  const auto* const bytes = reinterpret_cast<const unsigned char*>(
      machine.read_mono(nodes.first + static_cast<std::uint64_t>(slot) * words, words));
  machine.issue_mono(decoding_instructions(layout));
  MonoNode node;
  for (int child = 0; child < layout.width; ++child) {
    MonoNode::Four& four = node.four[child / 4];
    const auto i = static_cast<std::size_t>(child % 4);
    for (int axis = 0; axis < kAxes; ++axis) {
      four.lower[axis][i] = nodes.unit * coordinate(bytes, layout, axis, child);
      four.upper[axis][i] = nodes.unit * coordinate(bytes, layout, kAxes + axis, child);
    }
    node.reference[child] = load<std::uint32_t>(bytes, layout.reference_offset(child));
    if (node.reference[child] != PackedReference::kNowhere) node.children = child + 1;
  }
  return node;
}

}  // namespace path_tracer
