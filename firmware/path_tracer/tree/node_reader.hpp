#pragma once

#include <array>
#include <utility>

#include "firmware/cn/language/indexed.hpp"
#include "firmware/path_tracer/tree/node_ray.hpp"

/// Nodes as each PE reads its own from its SRAM.
namespace path_tracer {

using PolyAddress = poly<std::int32_t>;

/// One value for each child of a node, or for each word of a row of children.
template <class T, int count>
using Row = std::array<poly<T>, static_cast<std::size_t>(count)>;

template <class T, class OfPlace, int... place>
inline Row<T, sizeof...(place)> make_row(OfPlace&& of_place, std::integer_sequence<int, place...>) {
  return {of_place(place)...};
}
/// Makes a row of of_place(0), of_place(1), ...
template <class T, int count, class OfPlace>
inline Row<T, count> make_row(OfPlace&& of_place) {
  return make_row<T>(of_place, std::make_integer_sequence<int, count>());
}

template <class T>
inline poly<T> chosen(const mask& condition, const poly<T>& if_set, const poly<T>& otherwise) {
  return cn::IndexedRecord::chosen(condition, if_set, otherwise);
}

/// The planes of the children's boxes across an axis.
template <class Number, int width>
struct Planes {
  Row<Number, width> first;  ///< that the ray meets
  Row<Number, width> last;
};

/// Reads the coordinates of the children's boxes by component (lower x, y, z, upper x, y, z), the same
/// numbers as decode_box() of the testbench makes. If a ray goes backward along the axis, the upper planes
/// come first; the ray reads them from their places (IndexedRecord::chosen).
template <NodeFormat format, int width>
class NodeReader;

template <int width>
class NodeReader<NodeFormat::fp64, width> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) : node_(node) {}

  Planes<double, width> planes(int axis, const mask& backward) const {
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

  Planes<float, width> planes(int axis, const mask& backward) const {
    const Words lower = row(axis);
    const Words upper = row(kAxes + axis);
    return {halves(make_row<std::uint64_t, kWords>(
                [&](std::size_t i) { return chosen(backward, upper[i], lower[i]); })),
            halves(make_row<std::uint64_t, kWords>(
                [&](std::size_t i) { return chosen(backward, lower[i], upper[i]); }))};
  }

 private:
  static constexpr int kWords = width / 2;  ///< a word holds two children
  using Words = Row<std::uint64_t, kWords>;

  Words row(int component) const {
    return make_row<std::uint64_t, kWords>(
        [&](int i) { return node_.load<std::uint64_t>((component * kWords + i) * 8); });
  }
  static Row<float, width> halves(const Words& words) {
    return make_row<float, width>([&](std::size_t i) {
      return i % 2 == 0 ? cn::low_float(words[i / 2]) : cn::high_float(words[i / 2]);
    });
  }

  const cn::IndexedRecord& node_;
};

template <int width>
class NodeReader<NodeFormat::quantised8, width> {
 public:
  explicit NodeReader(const cn::IndexedRecord& node) {
    static_assert(sizeof(QuantisedFrame) == 16);
    const poly<std::uint64_t> x_and_y = node.load<std::uint64_t>(0);
    const poly<std::uint64_t> z_and_exponents = node.load<std::uint64_t>(8);
    origin_[0].assign_all_lanes(cn::low_float(x_and_y));
    origin_[1].assign_all_lanes(cn::high_float(x_and_y));
    origin_[2].assign_all_lanes(cn::low_float(z_and_exponents));
    const poly<std::uint32_t> exponents = cn::high_word(z_and_exponents);
    step_[0].assign_all_lanes(power_of_two(exponents));
    step_[1].assign_all_lanes(power_of_two(exponents >> 8));
    step_[2].assign_all_lanes(power_of_two(exponents >> 16));
    for (int i = 0; i < kStepWords; ++i)
      steps_[i].assign_all_lanes(node.load<std::uint64_t>(int{sizeof(QuantisedFrame)} + i * 8));
  }

  Planes<float, width> planes(int axis, const mask& backward) const {
    const Steps lower = row(axis);
    const Steps upper = row(kAxes + axis);
    return {coordinates(axis, make_row<float, kFours>(
                                  [&](std::size_t i) { return chosen(backward, upper[i], lower[i]); })),
            coordinates(axis, make_row<float, kFours>(
                                  [&](std::size_t i) { return chosen(backward, lower[i], upper[i]); }))};
  }

 private:
  static constexpr int kFours = width / 4;  ///< groups of four children
  static constexpr int kStepWords = 2 * kAxes * width / 8;
  /// Steps of four children in each float's bits.
  using Steps = Row<float, kFours>;

  Steps row(int component) const {
    return make_row<float, kFours>([&](int i) {
      const int place = component * kFours + i;
      const poly<std::uint64_t>& two = steps_[place / 2];
      return place % 2 == 0 ? cn::low_float(two) : cn::high_float(two);
    });
  }
  Row<float, width> coordinates(int axis, const Steps& steps) const {
    const auto of_four = [&](std::size_t four) {
      const poly4<float> numbers{cn::byte_of<0>(steps[four]), cn::byte_of<1>(steps[four]),
                                 cn::byte_of<2>(steps[four]), cn::byte_of<3>(steps[four])};
      return cn::multiply_add(numbers, same4(step_[axis]), same4(origin_[axis]));
    };
    const poly4<float> left = of_four(0);
    if constexpr (width == 4) {
      return {left[0], left[1], left[2], left[3]};
    } else {
      const poly4<float> right = of_four(1);
      return {left[0], left[1], left[2], left[3], right[0], right[1], right[2], right[3]};
    }
  }
  /// Returns the power of two whose exponent is in the lowest byte.
  static poly<float> power_of_two(const poly<std::uint32_t>& exponent) {
    return cn::float_of_bits((exponent & poly<std::uint32_t>(0xffu)) << 23);
  }

  poly<float> origin_[kAxes];
  poly<float> step_[kAxes];
  poly<std::uint64_t> steps_[kStepWords];
};

}  // namespace path_tracer
