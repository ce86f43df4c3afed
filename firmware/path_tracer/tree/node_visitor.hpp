#pragma once

#include "firmware/path_tracer/tree/node_reader.hpp"

/// Finds which children of a node a ray meets, and in which order.
namespace path_tracer {

/// Batcher's odd-even merge sort (Sorting Networks and Their Applications, AFIPS 1968): a network of 1, 5 or
/// 19 comparisons. Its last stage merges two sorted interleaved halves.
template <class Ray>
class SortingNetwork {
 public:
  template <int count>
  static void sort(poly<std::uint64_t>* entry) {
    if constexpr (count == 2) {
      Ray::put_in_order(entry[0], entry[1]);
    } else {
      sort<count / 2>(entry);
      sort<count / 2>(entry + count / 2);
      merge<count, 1>(entry);
    }
  }

 private:
  /// Merges `count` places, `stride` apart, whose even and odd places are each in order.
  template <int count, int stride>
  static void merge(poly<std::uint64_t>* entry) {
    if constexpr (2 * stride == count) {
      Ray::put_in_order(entry[0], entry[stride]);
    } else {
      merge<count, 2 * stride>(entry);
      merge<count, 2 * stride>(entry + stride);
      for (int i = stride; i + stride < count; i += 2 * stride)
        Ray::put_in_order(entry[i], entry[i + stride]);
    }
  }
};

/// A node's children in the order in which the ray enters them; kNoEntry for those that it does not meet.
template <int width>
struct VisitOrder {
  poly<std::uint64_t> entry[width];
};

template <NodeFormat format, int width>
class NodeVisitor {
 public:
  using Ray = NodeRay<format>;

  NodeVisitor(const Ray& ray, const NodeLayout& layout) : ray_(ray), layout_(layout) {}

  VisitOrder<width> visit(const PolyAddress& address) const {
    const cn::IndexedRecord node(address);
    const NodeReader<format, width> reader(node);
    const Slabs slabs = both(both(meet_planes(reader, 0), meet_planes(reader, 1)), meet_planes(reader, 2));
    const int references = layout_.reference_offset(0);
    const auto two = make_row<std::uint64_t, width / 2>(
        [&](int i) { return node.load<std::uint64_t>(references + i * 8); });
    VisitOrder<width> order;
    for (std::size_t i = 0; i < width; ++i) {
      const poly<std::uint32_t> reference = i % 2 == 0 ? cn::low_word(two[i / 2]) : cn::high_word(two[i / 2]);
      const poly<Number> entry = Ray::greater(poly<Number>(Number(0)), slabs.entry[i]);
      order.entry[i].assign_all_lanes(ray_.entry_of(entry, exit_of(slabs.exit[i], reference), reference));
    }
    SortingNetwork<Ray>::template sort<width>(order.entry);
    return order;
  }

  mask reaches(const poly<std::uint64_t>& entry) const { return ray_.reaches(entry); }

 private:
  using Number = typename Ray::Number;
  using Numbers = Row<Number, width>;

  /// The part of the ray within the boxes, for the axes so far. Each axis is completed before the next,
  /// because the simulator's processor would otherwise run out of registers.
  struct Slabs {
    Numbers entry;
    Numbers exit;
  };

  static Slabs both(const Slabs& a, const Slabs& b) {
    return {make_row<Number, width>([&](std::size_t i) { return Ray::greater(a.entry[i], b.entry[i]); }),
            make_row<Number, width>([&](std::size_t i) { return Ray::lesser(a.exit[i], b.exit[i]); })};
  }

  Slabs meet_planes(const NodeReader<format, width>& reader, int axis) const {
    const Planes<Number, width> planes = reader.planes(axis, ray_.backward(axis));
    cn::issue(cn::InstructionClass::int32_alu, 2);  // addresses by the sign of the direction
    const PlaneOperands<Number> first = ray_.first(axis);
    const PlaneOperands<Number> last = ray_.last(axis);
    if constexpr (width == 2) {
      return meet_two(planes, first, last);
    } else {
      return {distances(planes.first, first), distances(planes.last, last)};
    }
  }

  /// Returns an exit before any entry if the child leads nowhere. Other formats have an empty box there.
  static poly<Number> exit_of(const poly<Number>& exit, const poly<std::uint32_t>& reference) {
    if constexpr (format == NodeFormat::quantised8) {
      return cn::select(reference == poly<std::uint32_t>(PackedReference::kNowhere), poly<Number>(-1), exit);
    } else {
      return exit;
    }
  }

  static poly4<Number> four_distances(const poly4<Number>& planes, const poly4<Number>& origins,
                                      const poly4<Number>& scales) {
    return (origins - planes) * scales;
  }

  /// Computes four planes with one vector instruction.
  static Numbers distances(const Numbers& planes, const PlaneOperands<Number>& operands) {
    const auto four_from = [&](std::size_t i) {
      return four_distances({planes[i], planes[i + 1], planes[i + 2], planes[i + 3]}, same4(operands.origin),
                            same4(operands.scale));
    };
    const poly4<Number> a = four_from(0);
    if constexpr (width == 4) {
      return {a[0], a[1], a[2], a[3]};
    } else {
      const poly4<Number> b = four_from(4);
      return {a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]};
    }
  }

  /// Two children's first and last planes fill one vector.
  static Slabs meet_two(const Planes<Number, width>& planes, const PlaneOperands<Number>& first,
                        const PlaneOperands<Number>& last) {
    const poly4<Number> all =
        four_distances({planes.first[0], planes.first[1], planes.last[0], planes.last[1]},
                       {first.origin, first.origin, last.origin, last.origin},
                       {first.scale, first.scale, last.scale, last.scale});
    return {{all[0], all[1]}, {all[2], all[3]}};
  }

  const Ray& ray_;
  const NodeLayout& layout_;
};

}  // namespace path_tracer
