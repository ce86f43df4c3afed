#pragma once

#include <array>
#include <utility>

#include "firmware/cn/language/exact.hpp"
#include "firmware/cn/language/float_bits.hpp"
#include "firmware/cn/language/poly4.hpp"
#include "firmware/path_tracer/geometry/box.hpp"
#include "firmware/path_tracer/records/node_layout.hpp"
#include "firmware/path_tracer/records/traversal_record.hpp"

/// Rays in the number format in which nodes are tested: DoubleNodeRay for fp64, else SingleNodeRay.
namespace path_tracer {

using cn::poly4;

inline const poly<double>& component(const vec3<poly<double>>& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}
template <class T>
inline poly4<T> same4(const poly<T>& a) {
  return {a, a, a, a};
}

/// Operands of the distance of a plane across an axis: (origin - coordinate) * scale.
template <class Number>
struct PlaneOperands {
  poly<Number> origin;
  poly<Number> scale;
};

/// Tests in double precision; the same numbers as BoxRay.
class DoubleNodeRay {
 public:
  using Number = double;

  /// @param latest latest entry that matters
  DoubleNodeRay(const Point3& origin, const Direction3& direction, double /*to_node_unit*/,
                const poly<double>& latest)
      : ray_(origin, direction),
        backward_{ray_.minus_inverse().x > 0.0, ray_.minus_inverse().y > 0.0, ray_.minus_inverse().z > 0.0},
        limit_(cn::high_word(latest)) {}

  const mask& backward(int axis) const { return backward_[axis]; }
  /// Operands of the planes that the ray meets first, and last.
  PlaneOperands<double> first(int axis) const {
    return {component(ray_.origin(), axis), component(ray_.minus_inverse(), axis)};
  }
  PlaneOperands<double> last(int axis) const { return first(axis); }

  static poly<double> greater(const poly<double>& a, const poly<double>& b) { return cn::max(a, b); }
  static poly<double> lesser(const poly<double>& a, const poly<double>& b) { return cn::min(a, b); }

  /// Returns the upper half of the double at which a box is entered, above the reference; or kNoEntry. A
  /// child that leads nowhere has an empty box.
  /// @param entry +0 or more, never -0, whose bits are those of a large number
  poly<std::uint64_t> entry_of(const poly<double>& entry, const poly<double>& exit,
                               const poly<std::uint32_t>& reference) const {
    const poly<std::uint32_t> key = cn::high_word(entry);
    const mask met = (entry <= exit) & (key <= limit_);
    return cn::select(met, cn::join_words({key, reference}), poly<std::uint64_t>(kNoEntry));
  }
  mask reaches(const poly<std::uint64_t>& entry) const { return cn::high_word(entry) <= limit_; }

  static void put_in_order(poly<std::uint64_t>& first, poly<std::uint64_t>& second) {
    const mask swapped = second < first;
    const poly<std::uint64_t> lower = cn::select(swapped, second, first);
    second.assign_all_lanes(cn::select(swapped, first, second));
    first.assign_all_lanes(lower);
  }
  static constexpr std::uint64_t kNoEntry = ~std::uint64_t{0};

 private:
  BoxRay ray_;
  mask backward_[kAxes];
  poly<std::uint32_t> limit_;
};

/// Tests in single precision that are never stricter than BoxRay's: if BoxRay meets a box at a distance that
/// no hit of the scene exceeds, so does SingleNodeRay, and enters it no later. Three things ensure this.
///
/// Coordinates are in the node's unit, in which the scene's reach is 1 to 2 (to_node_unit()), and the
/// direction is scaled to a largest component of 0.7 to 1.5. So no distance of a hit is above 4.
///
/// The origin is moved along the axis by no less than its rounding, so that planes met first are nearer and
/// planes met last farther. With u = 2^-24, the scale is rounded to less than 1 - 2.9 u of its size for the
/// former and more than 1 + 2.9 u for the latter, while the difference, the product and all rounding in
/// double precision are within 2.1 u.
///
/// Components below 2^-60 are taken as 2^-60. The origin is moved by at least 2^-40, so a plane that is met
/// last is then at least 2^19 away, farther than any hit. For the same reason no distance that matters
/// underflows: a plane met last at all is 2^-42 away; a plane met first and still ahead was as far before the
/// origin was moved, and so is its limit.
class SingleNodeRay {
 public:
  using Number = float;

  /// @param to_node_unit factor of coordinates
  /// @param latest latest entry that matters, in lengths of the direction
  SingleNodeRay(const Point3& origin, const Direction3& direction, double to_node_unit,
                const poly<double>& latest) {
    const poly<double> largest =
        cn::max(cn::max(cn::abs(direction.x), cn::abs(direction.y)), cn::abs(direction.z));
    const poly<double> length = cn::nearest_power_of_two(largest);
    const poly4<double> scaled = as_vector(direction) * same4(cn::inverse_power_of_two(length));
    const poly<double> scale[kAxes] = {minus_inverse_of(scaled[0], kLeastComponent),
                                       minus_inverse_of(scaled[1], kLeastComponent),
                                       minus_inverse_of(scaled[2], kLeastComponent)};
    const poly4<double> from = as_vector(origin) * to_node_unit;
    set_origins(from, scale);
    set_scales(scale);
    limit_.assign_all_lanes(cn::convert<float>(latest * (length * (to_node_unit * (1.0 + kScaleMargin)))));
  }

  const mask& backward(int axis) const { return backward_[axis]; }
  const PlaneOperands<float>& first(int axis) const { return first_[axis]; }
  const PlaneOperands<float>& last(int axis) const { return last_[axis]; }

  static poly<float> greater(const poly<float>& a, const poly<float>& b) { return cn::max_by_bits(a, b); }
  static poly<float> lesser(const poly<float>& a, const poly<float>& b) { return cn::min_by_bits(a, b); }

  /// Returns the float at which a box is entered, above the reference; or kNoEntry.
  poly<std::uint64_t> entry_of(const poly<float>& entry, const poly<float>& exit,
                               const poly<std::uint32_t>& reference) const {
    const mask met = cn::at_most_by_bits(entry, cn::min_by_bits(exit, limit_));
    return cn::select(met, cn::join_words(entry, reference), poly<std::uint64_t>(kNoEntry));
  }
  mask reaches(const poly<std::uint64_t>& entry) const {
    return cn::at_most_by_bits(cn::high_float(entry), limit_);
  }

  static void put_in_order(poly<std::uint64_t>& first, poly<std::uint64_t>& second) {
    cn::put_in_order(first, second);
  }
  /// The largest finite double. It comes after the entry at infinity, whose word is a finite double, too.
  static constexpr std::uint64_t kNoEntry = 0x7fefffffffffffffu;

 private:
  static constexpr double kLeastComponent = 0x1p-60;
  static constexpr double kOriginMargin = 0x1p-23;  ///< relative to the origin's size
  static constexpr double kLeastOriginMargin = 0x1p-40;
  static constexpr double kScaleMargin = 0x1p-22;

  static poly4<double> as_vector(const vec3<poly<double>>& v) { return {v.x, v.y, v.z, v.z}; }

  void set_origins(const poly4<double>& from, const poly<double>* scale) {
    const poly4<double> size{cn::abs(from[0]), cn::abs(from[1]), cn::abs(from[2]), from[3]};
    const poly4<double> margin = size * kOriginMargin + kLeastOriginMargin;
    const poly4<double> forward{cn::flip_sign(margin[0], scale[0]), cn::flip_sign(margin[1], scale[1]),
                                cn::flip_sign(margin[2], scale[2]), margin[3]};
    const poly4<double> nearer = from - forward;
    const poly4<double> farther = from + forward;
    for (int axis = 0; axis < kAxes; ++axis) {
      first_[axis].origin.assign_all_lanes(cn::convert<float>(nearer[axis]));
      last_[axis].origin.assign_all_lanes(cn::convert<float>(farther[axis]));
    }
  }

  void set_scales(const poly<double>* scale) {
    const poly4<double> all{scale[0], scale[1], scale[2], scale[2]};
    const poly4<double> less = all * (1.0 - kScaleMargin);
    const poly4<double> more = all * (1.0 + kScaleMargin);
    for (int axis = 0; axis < kAxes; ++axis) {
      first_[axis].scale.assign_all_lanes(cn::convert<float>(less[axis]));
      last_[axis].scale.assign_all_lanes(cn::convert<float>(more[axis]));
      backward_[axis] = scale[axis] > 0.0;
    }
  }

  PlaneOperands<float> first_[kAxes];
  PlaneOperands<float> last_[kAxes];
  mask backward_[kAxes];
  poly<float> limit_;
};

template <NodeFormat format>
using NodeRay = std::conditional_t<format == NodeFormat::fp64, DoubleNodeRay, SingleNodeRay>;

}  // namespace path_tracer
