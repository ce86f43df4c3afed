#pragma once

#include "firmware/path_tracer/tree/mono_node.hpp"
#include "firmware/path_tracer/tree/node_ray.hpp"

/// Rays against the boxes of a node that is the same for all PEs.
namespace path_tracer {

inline poly<std::int32_t> signed_high_word(const poly<double>& a) {
  return cn::reinterpret_word<std::int32_t>(cn::high_word(a));
}

/// The distances at which a ray enters and leaves four children's boxes, by axis.
struct Slabs4 {
  poly4<double> entry[kAxes];
  poly4<double> exit[kAxes];

  /// Computes the same numbers as BoxRay. Nodes are the same for all PEs, but the near side of a box is not;
  /// so both sides are computed before they are told apart.
  Slabs4(const MonoNode::Four& four, const Point3& origin, const Direction3& minus_inverse) {
    for (int axis = 0; axis < kAxes; ++axis) {
      const poly<double>& scale = component(minus_inverse, axis);
      const poly4<double> from = same4(component(origin, axis));
      const poly4<double> lower = (from - four.lower[axis]) * same4(scale);
      const poly4<double> upper = (from - four.upper[axis]) * same4(scale);
      const mask backward = scale > 0.0;
      entry[axis].assign_all_lanes(cn::select(backward, upper, lower));
      exit[axis].assign_all_lanes(cn::select(backward, lower, upper));
    }
  }
};

/// Where a ray enters the box of one of the four children, +0 or more, and leaves it.
inline Slabs slabs_of(const Slabs4& four, std::size_t i) {
  return {from_origin(four.entry[0][i], four.entry[1][i], four.entry[2][i]),
          cn::min(cn::min(four.exit[0][i], four.exit[1][i]), four.exit[2][i])};
}

}  // namespace path_tracer
