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

/// Of the four children's boxes the planes across an axis.
struct Planes {
  poly4<double> first;  ///< that the ray meets
  poly4<double> last;
};

/// The coordinates of the four children in the components of their boxes (lower x, y, z, upper x, y, z), in
/// double precision whatever the format; the same numbers as the host's decode_box() makes of them. Where a
/// ray goes backward along the axis, the upper planes come first: they are read from their places
/// (IndexedRecord::chosen).
template <NodeFormat format>
class NodeReader;

template <class T>
inline poly<T> chosen(const mask& condition, const poly<T>& if_set, const poly<T>& otherwise) {
  return cn::IndexedRecord::chosen(condition, if_set, otherwise);
}

template <>
class NodeReader<NodeFormat::fp64> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) : node_(node) {}

  Planes planes(int axis, const mask& backward) const {
    const poly4<double> lower = row(axis);
    const poly4<double> upper = row(kAxes + axis);
    return {chosen4(backward, upper, lower), chosen4(backward, lower, upper)};
  }

 private:
  poly4<double> row(int component) const {
    const int at = component * kTraversalWidth * 8;
    return {node_.load<double>(at), node_.load<double>(at + 8), node_.load<double>(at + 16),
            node_.load<double>(at + 24)};
  }
  static poly4<double> chosen4(const mask& condition, const poly4<double>& if_set,
                               const poly4<double>& otherwise) {
    const auto element = [&](int i) { return chosen(condition, if_set[i], otherwise[i]); };
    return {element(0), element(1), element(2), element(3)};
  }

  const cn::IndexedRecord& node_;
};

template <>
class NodeReader<NodeFormat::fp32> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) : node_(node) {}

  Planes planes(int axis, const mask& backward) const {
    const Row lower = row(axis);
    const Row upper = row(kAxes + axis);
    return {widen(chosen(backward, upper.left, lower.left), chosen(backward, upper.right, lower.right)),
            widen(chosen(backward, lower.left, upper.left), chosen(backward, lower.right, upper.right))};
  }

 private:
  struct Row {  ///< two children each
    poly<std::uint64_t> left;
    poly<std::uint64_t> right;
  };
  Row row(int component) const {
    const int at = component * kTraversalWidth * 4;
    return {node_.load<std::uint64_t>(at), node_.load<std::uint64_t>(at + 8)};
  }
  static poly4<double> widen(const poly<std::uint64_t>& left, const poly<std::uint64_t>& right) {
    return {cn::widen_float(cn::low_word(left)), cn::widen_float(cn::high_word(left)),
            cn::widen_float(cn::low_word(right)), cn::widen_float(cn::high_word(right))};
  }

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

  Planes planes(int axis, const mask& backward) const {
    const poly<std::uint32_t> lower = row(axis);
    const poly<std::uint32_t> upper = row(kAxes + axis);
    return {coordinates(axis, chosen(backward, upper, lower)),
            coordinates(axis, chosen(backward, lower, upper))};
  }

 private:
  poly<std::uint32_t> row(int component) const {
    const poly<std::uint64_t>& two_rows = steps_[component / 2];
    return component % 2 == 0 ? cn::low_word(two_rows) : cn::high_word(two_rows);
  }
  poly4<double> coordinates(int axis, const poly<std::uint32_t>& steps) const {
    const poly4<double> numbers{byte(steps, 0), byte(steps, 1), byte(steps, 2), byte(steps, 3)};
    return cn::multiply_add(numbers, same4(step_[axis]), same4(origin_[axis]));
  }
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
    const Slabs4 slabs = both(both(meet_planes(reader, 0), meet_planes(reader, 1)), meet_planes(reader, 2));
    const int references = layout_.reference_offset(0);
    const poly<std::uint64_t> first = node.load<std::uint64_t>(references);
    const poly<std::uint64_t> second = node.load<std::uint64_t>(references + 8);
    const poly<std::uint32_t> reference[kTraversalWidth] = {cn::low_word(first), cn::high_word(first),
                                                            cn::low_word(second), cn::high_word(second)};
    VisitOrder order;
    for (int i = 0; i < kTraversalWidth; ++i) {
      const poly<double> from = cn::max(poly<double>(0.0), slabs.entry[i]);  // not -0, see from_origin
      const poly<double>& to = slabs.exit[i];
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
  /// The part of the ray within the four boxes, as far as some axes go. Each axis is done with before the
  /// next, or the host has more numbers at hand than registers.
  struct Slabs4 {
    poly4<double> entry;
    poly4<double> exit;
  };

  static Slabs4 both(const Slabs4& a, const Slabs4& b) {
    const auto entry = [&](int i) { return cn::max(a.entry[i], b.entry[i]); };
    const auto exit = [&](int i) { return cn::min(a.exit[i], b.exit[i]); };
    return {{entry(0), entry(1), entry(2), entry(3)}, {exit(0), exit(1), exit(2), exit(3)}};
  }

  Slabs4 meet_planes(const NodeReader<format>& reader, int axis) const {
    const poly4<double> origin = same4(component(ray_.origin(), axis));
    const poly4<double> scale = same4(component(ray_.minus_inverse(), axis));
    const Planes planes = reader.planes(axis, backward_[axis]);
    cn::issue(cn::InstructionClass::int32_alu, 2);  // where the sign of the direction has them read
    return {(origin - planes.first) * scale, (origin - planes.last) * scale};
  }

  const BoxRay& ray_;
  const NodeLayout& layout_;
  mask backward_[kAxes];
};

}  // namespace path_tracer
