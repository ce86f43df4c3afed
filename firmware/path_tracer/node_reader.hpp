#pragma once

#include "firmware/cn/exact.hpp"
#include "firmware/cn/indexed.hpp"
#include "firmware/cn/poly4.hpp"
#include "firmware/path_tracer/box.hpp"
#include "firmware/path_tracer/node_layout.hpp"
#include "firmware/path_tracer/traversal_record.hpp"

/// Nodes as a PE reads them from its own SRAM, each PE another one.
namespace path_tracer {

using cn::poly4;
using PolyAddress = poly<std::int32_t>;

inline poly4<double> same4(const poly<double>& a) {
  return {a, a, a, a};
}

inline constexpr int kAxes = 3;
inline const poly<double>& component(const vec3<poly<double>>& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// Coordinates of the four children in one component of their boxes, in double precision whatever the format;
/// the same numbers as the host's decode_box() makes of them.
template <NodeFormat format>
class NodeReader;

template <>
class NodeReader<NodeFormat::fp64> {
 public:
  explicit NodeReader(const PolyAddress&) {}
  static poly4<double> row(int, const PolyAddress& at) {
    return {cn::load_at<double>(at), cn::load_at<double>(at + 8), cn::load_at<double>(at + 16),
            cn::load_at<double>(at + 24)};
  }
};

template <>
class NodeReader<NodeFormat::fp32> {
 public:
  explicit NodeReader(const PolyAddress&) {}
  static poly4<double> row(int, const PolyAddress& at) {
    const poly<std::uint64_t> first = cn::load_at<std::uint64_t>(at);
    const poly<std::uint64_t> second = cn::load_at<std::uint64_t>(at + 8);
    return {cn::widen_float(cn::low_word(first)), cn::widen_float(cn::high_word(first)),
            cn::widen_float(cn::low_word(second)), cn::widen_float(cn::high_word(second))};
  }
};

template <>
class NodeReader<NodeFormat::quantised8> {
 public:
  explicit NodeReader(const PolyAddress& node) {
    const poly<std::uint64_t> exponents = cn::load_at<std::uint64_t>(node + int(offsetof(QuantisedFrame, exponent)));
    for (int axis = 0; axis < kAxes; ++axis) {
      origin_[axis].become(cn::load_at<double>(node + axis * 8));
      step_[axis].become(power_of_two(exponents >> (16 * axis)));
    }
  }
  poly4<double> row(int axis, const PolyAddress& at) const {
    const poly<std::uint32_t> steps = cn::load_at<std::uint32_t>(at);
    const poly4<double> numbers{byte(steps, 0), byte(steps, 1), byte(steps, 2), byte(steps, 3)};
    return cn::multiply_add(numbers, same4(step_[axis]), same4(origin_[axis]));
  }

 private:
  static poly<double> byte(const poly<std::uint32_t>& word, int index) {
    return cn::convert<double>((word >> (8 * index)) & poly<std::uint32_t>(0xffu));
  }
  /// 2^(low 16 bits, signed), which is no less than that of the smallest normal double.
  static poly<double> power_of_two(const poly<std::uint64_t>& exponent) {
    const poly<std::uint64_t> biased = exponent + std::uint64_t{1023};
    return cn::reinterpret<double>((biased & poly<std::uint64_t>(0x7ffu)) << 52);
  }

  poly<double> origin_[kAxes];
  poly<double> step_[kAxes];
};

/// A node's children, in the order in which the ray enters them; kNoEntry for those that it does not meet.
struct VisitOrder {
  poly<std::uint64_t> entry[kTraversalWidth];
};

inline void put_in_order(poly<std::uint64_t>& first, poly<std::uint64_t>& second) {
  const mask swapped = second < first;
  const poly<std::uint64_t> lower = cn::select(swapped, second, first);
  second.become(cn::select(swapped, first, second));
  first.become(lower);
}

/// A ray and the offsets at which it finds the near and far sides of boxes.
template <NodeFormat format>
class NodeVisitor {
 public:
  NodeVisitor(const BoxRay& ray, const NodeLayout& layout) : ray_(ray), layout_(layout) {
    const poly<std::int32_t> lower_to_upper = kAxes * kTraversalWidth * layout.coordinate_bytes();
    for (int axis = 0; axis < kAxes; ++axis) {
      const mask backward = component(ray.minus_inverse(), axis) > 0.0;
      const poly<std::int32_t> none = 0;
      const int lower = layout.coordinate_offset(axis, 0);
      near_[axis].become(cn::select(backward, lower_to_upper, none) + lower);
      far_[axis].become(cn::select(backward, none, lower_to_upper) + lower);
    }
  }

  /// @param limit the upper half of the latest entry that is of use
  VisitOrder visit(const PolyAddress& node, const poly<std::uint32_t>& limit) const {
    const NodeReader<format> reader(node);
    poly4<double> entry[kAxes];
    poly4<double> exit[kAxes];
    for (int axis = 0; axis < kAxes; ++axis) {
      const poly4<double> origin = same4(component(ray_.origin(), axis));
      const poly4<double> scale = same4(component(ray_.minus_inverse(), axis));
      entry[axis].become((origin - reader.row(axis, node + near_[axis])) * scale);
      exit[axis].become((origin - reader.row(axis, node + far_[axis])) * scale);
    }
    const int references = layout_.reference_offset(0);
    const poly<std::uint64_t> first = cn::load_at<std::uint64_t>(node + references);
    const poly<std::uint64_t> second = cn::load_at<std::uint64_t>(node + (references + 8));
    const poly<std::uint32_t> reference[kTraversalWidth] = {cn::low_word(first), cn::high_word(first),
                                                            cn::low_word(second), cn::high_word(second)};
    VisitOrder order;
    for (int i = 0; i < kTraversalWidth; ++i) {
      const poly<double> from = from_origin(entry[0][i], entry[1][i], entry[2][i]);
      const poly<double> to = cn::min(cn::min(exit[0][i], exit[1][i]), exit[2][i]);
      const poly<std::uint32_t> key = cn::high_word(from);
      const mask met = (from <= to) & (key <= limit) & (reference[i] != PackedReference::kNowhere);
      order.entry[i].become(
          cn::select(met, cn::join_words({key, reference[i]}), poly<std::uint64_t>(kNoEntry)));
    }
    put_in_order(order.entry[0], order.entry[1]);
    put_in_order(order.entry[2], order.entry[3]);
    put_in_order(order.entry[0], order.entry[2]);
    put_in_order(order.entry[1], order.entry[3]);
    put_in_order(order.entry[1], order.entry[2]);
    return order;
  }

 private:
  const BoxRay& ray_;
  const NodeLayout& layout_;
  poly<std::int32_t> near_[kAxes];
  poly<std::int32_t> far_[kAxes];
};

}  // namespace path_tracer
