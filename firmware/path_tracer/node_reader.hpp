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

/// The coordinates of the four children in the components of their boxes (lower x, y, z, upper x, y, z), in
/// double precision whatever the format; the same numbers as the host's decode_box() makes of them.
template <NodeFormat format>
class NodeReader;

template <>
class NodeReader<NodeFormat::fp64> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) : node_(node) {}

  poly4<double> row(int component) const {
    const int at = component * kTraversalWidth * 8;
    return {node_.load<double>(at), node_.load<double>(at + 8), node_.load<double>(at + 16),
            node_.load<double>(at + 24)};
  }

 private:
  const cn::IndexedRecord& node_;
};

template <>
class NodeReader<NodeFormat::fp32> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) : node_(node) {}

  poly4<double> row(int component) const {
    const int at = component * kTraversalWidth * 4;
    const poly<std::uint64_t> first = node_.load<std::uint64_t>(at);
    const poly<std::uint64_t> second = node_.load<std::uint64_t>(at + 8);
    return {cn::widen_float(cn::low_word(first)), cn::widen_float(cn::high_word(first)),
            cn::widen_float(cn::low_word(second)), cn::widen_float(cn::high_word(second))};
  }

 private:
  const cn::IndexedRecord& node_;
};

template <>
class NodeReader<NodeFormat::quantised8> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) {
    const poly<std::uint64_t> exponents = node.load<std::uint64_t>(kAxes * 8);
    for (int axis = 0; axis < kAxes; ++axis) {
      origin_[axis].become(node.load<double>(axis * 8));
      step_[axis].become(power_of_two(exponents >> (16 * axis)));
    }
    constexpr int kFrameBytes = sizeof(QuantisedFrame);
    for (int i = 0; i < kAxes; ++i) steps_[i].become(node.load<std::uint64_t>(kFrameBytes + i * 8));
  }

  poly4<double> row(int component) const {
    const poly<std::uint64_t>& two_rows = steps_[component / 2];
    const poly<std::uint32_t> steps = component % 2 == 0 ? cn::low_word(two_rows) : cn::high_word(two_rows);
    const poly4<double> numbers{byte(steps, 0), byte(steps, 1), byte(steps, 2), byte(steps, 3)};
    const int axis = component % kAxes;
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
  poly<std::uint64_t> steps_[kAxes];  ///< two components each
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

/// A ray and which sides of boxes it meets first.
template <NodeFormat format>
class NodeVisitor {
 public:
  NodeVisitor(const BoxRay& ray, const NodeLayout& layout)
      : ray_(ray),
        layout_(layout),
        backward_{ray.minus_inverse().x > 0.0, ray.minus_inverse().y > 0.0, ray.minus_inverse().z > 0.0} {}

  /// @param limit the upper half of the latest entry that is of use
  VisitOrder visit(const PolyAddress& address, const poly<std::uint32_t>& limit) const {
    const cn::IndexedRecord node(address);
    const NodeReader<format> reader(node);
    poly4<double> entry[kAxes];
    poly4<double> exit[kAxes];
    for_each_axis(reader, entry, exit, std::make_index_sequence<kAxes>());
    const int references = layout_.reference_offset(0);
    const poly<std::uint64_t> first = node.load<std::uint64_t>(references);
    const poly<std::uint64_t> second = node.load<std::uint64_t>(references + 8);
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
  template <std::size_t... axis>
  void for_each_axis(const NodeReader<format>& reader, poly4<double> (&entry)[kAxes],
                     poly4<double> (&exit)[kAxes], std::index_sequence<axis...>) const {
    (meet_planes(reader, int(axis), entry[axis], exit[axis]), ...);
  }

  void meet_planes(const NodeReader<format>& reader, int axis, poly4<double>& entry,
                   poly4<double>& exit) const {
    const poly4<double> origin = same4(component(ray_.origin(), axis));
    const poly4<double> scale = same4(component(ray_.minus_inverse(), axis));
    const poly4<double> lower = reader.row(axis);
    const poly4<double> upper = reader.row(kAxes + axis);
    cn::issue(cn::InstructionClass::int32_alu, 2);  // where the sign of the direction has them read
    entry.become((origin - chosen4(backward_[axis], upper, lower)) * scale);
    exit.become((origin - chosen4(backward_[axis], lower, upper)) * scale);
  }

  static poly4<double> chosen4(const mask& condition, const poly4<double>& if_set,
                               const poly4<double>& otherwise) {
    const auto element = [&](int i) { return cn::IndexedRecord::chosen(condition, if_set[i], otherwise[i]); };
    return {element(0), element(1), element(2), element(3)};
  }

  const BoxRay& ray_;
  const NodeLayout& layout_;
  mask backward_[kAxes];
};

}  // namespace path_tracer
