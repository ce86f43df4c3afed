#pragma once

#include <array>
#include <utility>

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

/// One of something for each of a node's children, or for each word of a row of them.
template <class T, int count>
using Row = std::array<poly<T>, static_cast<std::size_t>(count)>;

template <class T, class OfPlace, int... place>
inline Row<T, sizeof...(place)> make_row(OfPlace&& of_place, std::integer_sequence<int, place...>) {
  return {of_place(place)...};
}
/// Of of_place(0), of_place(1), ...
template <class T, int count, class OfPlace>
inline Row<T, count> make_row(OfPlace&& of_place) {
  return make_row<T>(of_place, std::make_integer_sequence<int, count>());
}

template <class T>
inline poly<T> chosen(const mask& condition, const poly<T>& if_set, const poly<T>& otherwise) {
  return cn::IndexedRecord::chosen(condition, if_set, otherwise);
}

/// Of the children's boxes the planes across an axis.
template <int width>
struct Planes {
  Row<double, width> first;  ///< that the ray meets
  Row<double, width> last;
};

/// The coordinates of the children in the components of their boxes (lower x, y, z, upper x, y, z), in
/// double precision whatever the format; the same numbers as the host's decode_box() makes of them. Where a
/// ray goes backward along the axis, the upper planes come first: they are read from their places
/// (IndexedRecord::chosen).
template <NodeFormat format, int width>
class NodeReader;

template <int width>
class NodeReader<NodeFormat::fp64, width> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) : node_(node) {}

  Planes<width> planes(int axis, const mask& backward) const {
    const Row<double, width> lower = row(axis);
    const Row<double, width> upper = row(kAxes + axis);
    return {make_row<double, width>([&](std::size_t i) { return chosen(backward, upper[i], lower[i]); }),
            make_row<double, width>([&](std::size_t i) { return chosen(backward, lower[i], upper[i]); })};
  }

 private:
  Row<double, width> row(int component) const {
    return make_row<double, width>([&](int i) { return node_.load<double>((component * width + i) * 8); });
  }

  const cn::IndexedRecord& node_;
};

template <int width>
class NodeReader<NodeFormat::fp32, width> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) : node_(node) {}

  Planes<width> planes(int axis, const mask& backward) const {
    const Words lower = row(axis);
    const Words upper = row(kAxes + axis);
    return {widen(make_row<std::uint64_t, kWords>(
                [&](std::size_t i) { return chosen(backward, upper[i], lower[i]); })),
            widen(make_row<std::uint64_t, kWords>(
                [&](std::size_t i) { return chosen(backward, lower[i], upper[i]); }))};
  }

 private:
  static constexpr int kWords = width / 2;  ///< of two children each
  using Words = Row<std::uint64_t, kWords>;

  Words row(int component) const {
    return make_row<std::uint64_t, kWords>(
        [&](int i) { return node_.load<std::uint64_t>((component * kWords + i) * 8); });
  }
  static Row<double, width> widen(const Words& words) {
    return make_row<double, width>([&](std::size_t i) {
      const poly<std::uint64_t>& word = words[i / 2];
      return cn::widen_float(i % 2 == 0 ? cn::low_word(word) : cn::high_word(word));
    });
  }

  const cn::IndexedRecord& node_;
};

template <int width>
class NodeReader<NodeFormat::quantised8, width> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) {
    const poly<std::uint64_t> exponents = node.load<std::uint64_t>(kAxes * 8);
    for (int axis = 0; axis < kAxes; ++axis) {
      origin_[axis].become(node.load<double>(axis * 8));
      step_[axis].become(power_of_two(exponents >> (16 * axis)));
    }
    constexpr int kFrameBytes = sizeof(QuantisedFrame);
    for (int i = 0; i < kStepWords; ++i) steps_[i].become(node.load<std::uint64_t>(kFrameBytes + i * 8));
  }

  Planes<width> planes(int axis, const mask& backward) const {
    const Steps lower = row(axis);
    const Steps upper = row(kAxes + axis);
    return {coordinates(axis, make_row<std::uint32_t, kFours>(
                                  [&](std::size_t i) { return chosen(backward, upper[i], lower[i]); })),
            coordinates(axis, make_row<std::uint32_t, kFours>(
                                  [&](std::size_t i) { return chosen(backward, lower[i], upper[i]); }))};
  }

 private:
  static constexpr int kFours = width / 4;  ///< of children
  static constexpr int kStepWords = 2 * kAxes * width / 8;
  using Steps = Row<std::uint32_t, kFours>;

  Steps row(int component) const {
    return make_row<std::uint32_t, kFours>([&](int i) {
      const int place = component * kFours + i;
      const poly<std::uint64_t>& two = steps_[place / 2];
      return place % 2 == 0 ? cn::low_word(two) : cn::high_word(two);
    });
  }
  Row<double, width> coordinates(int axis, const Steps& steps) const {
    const auto of_four = [&](std::size_t four) {
      const poly4<double> numbers{byte(steps[four], 0), byte(steps[four], 1), byte(steps[four], 2),
                                  byte(steps[four], 3)};
      return cn::multiply_add(numbers, same4(step_[axis]), same4(origin_[axis]));
    };
    const poly4<double> left = of_four(0);
    if constexpr (width == 4) {
      return {left[0], left[1], left[2], left[3]};
    } else {
      const poly4<double> right = of_four(1);
      return {left[0], left[1], left[2], left[3], right[0], right[1], right[2], right[3]};
    }
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
  poly<std::uint64_t> steps_[kStepWords];
};

/// A node's children, in the order in which the ray enters them; kNoEntry for those that it does not meet.
template <int width>
struct VisitOrder {
  poly<std::uint64_t> entry[width];
};

inline void put_in_order(poly<std::uint64_t>& first, poly<std::uint64_t>& second) {
  const mask swapped = second < first;
  const poly<std::uint64_t> lower = cn::select(swapped, second, first);
  second.become(cn::select(swapped, first, second));
  first.become(lower);
}

/// Of `count` places, each `stride` behind the one before, the two halves of which are in order alternately.
template <int count, int stride>
inline void merge(poly<std::uint64_t>* entry) {
  if constexpr (2 * stride == count) {
    put_in_order(entry[0], entry[stride]);
  } else {
    merge<count, 2 * stride>(entry);
    merge<count, 2 * stride>(entry + stride);
    for (int i = stride; i + stride < count; i += 2 * stride) put_in_order(entry[i], entry[i + stride]);
  }
}

/// Batcher's odd-even merge sort (Sorting Networks and Their Applications, AFIPS 1968): a network of 1, 5 or
/// 19 comparisons.
template <int count>
inline void sort(poly<std::uint64_t>* entry) {
  if constexpr (count == 2) {
    put_in_order(entry[0], entry[1]);
  } else {
    constexpr int kHalf = count / 2;
    sort<kHalf>(entry);
    sort<kHalf>(entry + kHalf);
    merge<count, 1>(entry);
  }
}

/// A ray and which sides of boxes it meets first.
template <NodeFormat format, int width>
class NodeVisitor {
 public:
  NodeVisitor(const BoxRay& ray, const NodeLayout& layout)
      : ray_(ray),
        layout_(layout),
        backward_{ray.minus_inverse().x > 0.0, ray.minus_inverse().y > 0.0, ray.minus_inverse().z > 0.0} {}

  /// @param limit the upper half of the latest entry that is of use
  VisitOrder<width> visit(const PolyAddress& address, const poly<std::uint32_t>& limit) const {
    const cn::IndexedRecord node(address);
    const NodeReader<format, width> reader(node);
    const Slabs slabs = both(both(meet_planes(reader, 0), meet_planes(reader, 1)), meet_planes(reader, 2));
    const int references = layout_.reference_offset(0);
    const auto two = make_row<std::uint64_t, width / 2>(
        [&](int i) { return node.load<std::uint64_t>(references + i * 8); });
    VisitOrder<width> order;
    for (std::size_t i = 0; i < width; ++i) {
      const poly<std::uint32_t> reference = i % 2 == 0 ? cn::low_word(two[i / 2]) : cn::high_word(two[i / 2]);
      const poly<double> from = cn::max(poly<double>(0.0), slabs.entry[i]);  // not -0, see from_origin
      const poly<double>& to = slabs.exit[i];
      const poly<std::uint32_t> key = cn::high_word(from);
      const mask met = (from <= to) & (key <= limit) & (reference != PackedReference::kNowhere);
      order.entry[i].become(cn::select(met, cn::join_words({key, reference}), poly<std::uint64_t>(kNoEntry)));
    }
    sort<width>(order.entry);
    return order;
  }

 private:
  /// The part of the ray within the boxes, as far as some axes go. Each axis is done with before the next, or
  /// the host has more numbers at hand than registers.
  struct Slabs {
    Row<double, width> entry;
    Row<double, width> exit;
  };

  static Slabs both(const Slabs& a, const Slabs& b) {
    return {make_row<double, width>([&](std::size_t i) { return cn::max(a.entry[i], b.entry[i]); }),
            make_row<double, width>([&](std::size_t i) { return cn::min(a.exit[i], b.exit[i]); })};
  }

  Slabs meet_planes(const NodeReader<format, width>& reader, int axis) const {
    const Planes<width> planes = reader.planes(axis, backward_[axis]);
    cn::issue(cn::InstructionClass::int32_alu, 2);  // where the sign of the direction has them read
    return meet(planes, component(ray_.origin(), axis), component(ray_.minus_inverse(), axis));
  }

  /// Four planes to a vector instruction; of two children both planes make one.
  static Slabs meet(const Planes<width>& planes, const poly<double>& origin, const poly<double>& scale) {
    const auto four = [&](const poly<double>& a, const poly<double>& b, const poly<double>& c,
                          const poly<double>& d) {
      return (same4(origin) - poly4<double>(a, b, c, d)) * same4(scale);
    };
    const Row<double, width>& first = planes.first;
    const Row<double, width>& last = planes.last;
    if constexpr (width == 2) {
      const poly4<double> all = four(first[0], first[1], last[0], last[1]);
      return {{all[0], all[1]}, {all[2], all[3]}};
    } else if constexpr (width == 4) {
      const poly4<double> entry = four(first[0], first[1], first[2], first[3]);
      const poly4<double> exit = four(last[0], last[1], last[2], last[3]);
      return {{entry[0], entry[1], entry[2], entry[3]}, {exit[0], exit[1], exit[2], exit[3]}};
    } else {
      const poly4<double> entry = four(first[0], first[1], first[2], first[3]);
      const poly4<double> more = four(first[4], first[5], first[6], first[7]);
      const poly4<double> exit = four(last[0], last[1], last[2], last[3]);
      const poly4<double> others = four(last[4], last[5], last[6], last[7]);
      return {{entry[0], entry[1], entry[2], entry[3], more[0], more[1], more[2], more[3]},
              {exit[0], exit[1], exit[2], exit[3], others[0], others[1], others[2], others[3]}};
    }
  }

  const BoxRay& ray_;
  const NodeLayout& layout_;
  mask backward_[kAxes];
};

}  // namespace path_tracer
