#include "testbench/bvh/node_format.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace testbench {
namespace {

using path_tracer::ChildReference;
using path_tracer::NodeFormat;
using path_tracer::NodeLayout;
using path_tracer::PackedReference;
using path_tracer::QuantisedFrame;

constexpr int kAxes = 3;
constexpr int kSteps = 255;
constexpr int kExponentBias = 127;
constexpr int kLeastExponent = 1;                      // biased exponent of the smallest normal float
constexpr int kLargestExponent = kExponentBias + 119;  // the largest for which 255 steps are finite

template <class T>
void store(std::uint8_t* node, int offset, const T& value) {
  std::memcpy(node + offset, &value, sizeof(value));
}
template <class T>
T load(const std::uint8_t* node, int offset) {
  T value;
  std::memcpy(&value, node + offset, sizeof(value));
  return value;
}

float rounded_down(double number) {
  const auto nearest = static_cast<float>(number);
  return double(nearest) <= number ? nearest
                                   : std::nextafter(nearest, -std::numeric_limits<float>::infinity());
}
float rounded_up(double number) {
  return -rounded_down(-number);
}

double coordinate(const QuantisedFrame& frame, int axis, int step) {
  return double(path_tracer::quantised_coordinate(frame, axis, step));
}

/// The frame of a node's quantised boxes: on each axis, the smallest power of two as a step with which 255
/// steps span the box.
QuantisedFrame frame_around(const Box& box) {
  QuantisedFrame frame{};
  for (int axis = 0; axis < kAxes; ++axis) {
    frame.origin[axis] = rounded_down(box.lower[axis]);
    const double half_extent =
        0.5 * box.upper[axis] - 0.5 * frame.origin[axis];  // halved, as the full extent may overflow
    int exponent = kLeastExponent;
    if (half_extent > 0.0)
      exponent =
          std::clamp(std::ilogb(half_extent / kSteps) + 1 + kExponentBias, kLeastExponent, kLargestExponent);
    frame.exponent[axis] = static_cast<std::uint8_t>(exponent);
    while (exponent < kLargestExponent && coordinate(frame, axis, kSteps) < box.upper[axis])
      frame.exponent[axis] = static_cast<std::uint8_t>(++exponent);
  }
  return frame;
}

/// The step near `number` at which the searches below start.
int step_near(const QuantisedFrame& frame, int axis, double number) {
  const double steps =
      std::ldexp(0.5 * number - 0.5 * double(frame.origin[axis]), 1 + kExponentBias - frame.exponent[axis]);
  return static_cast<int>(std::clamp(std::floor(steps), 0.0, double(kSteps)));
}

/// The last step whose rounded coordinate is not above `number`, and the first whose is not below it.
std::uint8_t step_below(const QuantisedFrame& frame, int axis, double number) {
  int step = step_near(frame, axis, number);
  while (step < kSteps && coordinate(frame, axis, step + 1) <= number) ++step;
  while (step > 0 && coordinate(frame, axis, step) > number) --step;
  return static_cast<std::uint8_t>(step);
}
std::uint8_t step_above(const QuantisedFrame& frame, int axis, double number) {
  int step = step_near(frame, axis, number);
  while (step > 0 && coordinate(frame, axis, step - 1) >= number) --step;
  while (step < kSteps && coordinate(frame, axis, step) < number) ++step;
  return static_cast<std::uint8_t>(step);
}

void encode_box(const Box& box, const NodeLayout& layout, const QuantisedFrame& frame, int child,
                std::uint8_t* to) {
  for (int axis = 0; axis < kAxes; ++axis) {
    const int lower = layout.coordinate_offset(axis, child);
    const int upper = layout.coordinate_offset(kAxes + axis, child);
    switch (layout.format) {
      case NodeFormat::fp64:
        store(to, lower, box.lower[axis]);
        store(to, upper, box.upper[axis]);
        break;
      case NodeFormat::fp32:
        store(to, lower, rounded_down(box.lower[axis]));
        store(to, upper, rounded_up(box.upper[axis]));
        break;
      case NodeFormat::quantised8:
        store(to, lower, step_below(frame, axis, box.lower[axis]));
        store(to, upper, step_above(frame, axis, box.upper[axis]));
        break;
    }
  }
}

ChildReference reference_to(const BvhChild& child, const std::vector<std::int32_t>& slot_of_node) {
  if (child.is_leaf()) return {child.first_triangle, child.triangle_count};
  return {slot_of_node[std::size_t(child.node)], 0};
}

}  // namespace

void encode_node(const BvhNode& node, const NodeLayout& layout, const std::vector<std::int32_t>& slot_of_node,
                 std::uint8_t* to) {
  std::memset(to, 0, std::size_t(layout.node_bytes()));
  QuantisedFrame frame{};
  if (layout.format == NodeFormat::quantised8) {
    frame = frame_around(node.box());
    store(to, 0, frame);
  }
  for (int i = 0; i < layout.width; ++i) {
    const bool exists = i < node.child_count;
    store(to, layout.reference_offset(i),
          PackedReference::pack(exists ? reference_to(node.child[std::size_t(i)], slot_of_node)
                                       : ChildReference{}));
    if (exists) {
      encode_box(node.child[std::size_t(i)].box, layout, frame, i, to);
    } else if (layout.format != NodeFormat::quantised8) {
      encode_box(Box{}, layout, frame, i, to);
    }
  }
}

Box decode_box(const std::uint8_t* node, const NodeLayout& layout, int child) {
  const auto frame =
      layout.format == NodeFormat::quantised8 ? load<QuantisedFrame>(node, 0) : QuantisedFrame{};
  const auto number = [&](int component) {
    const int offset = layout.coordinate_offset(component, child);
    if (layout.format == NodeFormat::fp64) return load<double>(node, offset);
    if (layout.format == NodeFormat::fp32) return double(load<float>(node, offset));
    return coordinate(frame, component % kAxes, load<std::uint8_t>(node, offset));
  };
  Box box;
  for (int axis = 0; axis < kAxes; ++axis) {
    box.lower[axis] = number(axis);
    box.upper[axis] = number(kAxes + axis);
  }
  return box;
}

ChildReference decode_reference(const std::uint8_t* node, const NodeLayout& layout, int child) {
  return PackedReference::unpack(load<std::uint32_t>(node, layout.reference_offset(child)));
}

}  // namespace testbench
