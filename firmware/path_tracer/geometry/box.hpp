#pragma once

#include "firmware/cn/language/math.hpp"
#include "firmware/cn/language/vec3.hpp"

/// Tests of rays against axis-aligned boxes. Rounding preserves order: with each step rounded the same way, a
/// ray that meets a box meets every box around it, and enters the outer one no later. So the tree needs no
/// margins except those of its leaves (triangle_record.hpp).
namespace path_tracer {

using cn::mask;
using cn::poly;
using cn::vec3;
using Direction3 = vec3<poly<double>>;
using Point3 = vec3<poly<double>>;

/// The part of a ray within a box, in lengths of its direction; entry > exit if the ray misses the box.
struct Slabs {
  poly<double> entry;  ///< 0 if the ray starts within
  poly<double> exit;
};

/// Returns where the last of three slabs is entered, +0 or more (never -0, whose bits are those of a large
/// number).
inline poly<double> from_origin(const poly<double>& x, const poly<double>& y, const poly<double>& z) {
  return cn::max(poly<double>(0.0), cn::max(cn::max(x, y), z));
}

/// Returns -1 / component; the component's size is taken as at least `least`.
inline poly<double> minus_inverse_of(const poly<double>& component, double least) {
  const poly<double> size = cn::max(cn::abs(component), poly<double>(least));
  return -1.0 / cn::flip_sign(size, component);
}

/// A ray prepared for tests of boxes.
class BoxRay {
 public:
  BoxRay(const Point3& origin, const Direction3& direction)
      : origin_(origin),
        minus_inverse_{minus_inverse_of(direction.x, kLeastComponent),
                       minus_inverse_of(direction.y, kLeastComponent),
                       minus_inverse_of(direction.z, kLeastComponent)} {}

  const Point3& origin() const { return origin_; }
  /// -1 / direction, always finite: (origin - coordinate) times this is the distance of a plane.
  const Direction3& minus_inverse() const { return minus_inverse_; }

  Slabs slabs(const Point3& lower, const Point3& upper) const {
    const Direction3 a = (origin_ - lower) * minus_inverse_;
    const Direction3 b = (origin_ - upper) * minus_inverse_;
    const poly<double> entry = from_origin(cn::min(a.x, b.x), cn::min(a.y, b.y), cn::min(a.z, b.z));
    const poly<double> exit = cn::min(cn::min(cn::max(a.x, b.x), cn::max(a.y, b.y)), cn::max(a.z, b.z));
    return {entry, exit};
  }

 private:
  /// Least size of a direction's component, which replaces 0. It is so small that no scene has a plane at the
  /// distance that results.
  static constexpr double kLeastComponent = 0x1p-900;

  Point3 origin_;
  Direction3 minus_inverse_;
};

/// Returns the latest entry of a box that may contain a hit at `distance`; the margin covers the rounded
/// division.
inline poly<double> latest_entry(const poly<double>& distance) {
  return distance * (1.0 + 0x1p-50);
}

}  // namespace path_tracer
