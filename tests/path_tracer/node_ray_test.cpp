#include "firmware/path_tracer/tree/node_ray.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "tests/support/vectors.hpp"

namespace node_ray_test {

using cn::poly;
using path_tracer::NodeFormat;
using path_tracer::SingleNodeRay;
using path_tracer::to_node_unit;
using test_support::kComponents;
using test_support::load;
using test_support::load3;
using test_support::PerPe;
using test_support::Ray;
using test_support::store;
using test_support::Vector;

struct Box {
  Vector lower;
  Vector upper;
};

float rounded_down(double number) {
  const auto nearest = static_cast<float>(number);
  return double(nearest) <= number ? nearest : std::nextafter(nearest, -INFINITY);
}

/// A scene of that size: boxes and origins lie within it, and no distance exceeds its reach.
class SingleNodeRayTest : public test_support::StripFixture, public testing::WithParamInterface<double> {
 protected:
  SingleNodeRayTest() : StripFixture(1024) {}

  double scale() const { return GetParam(); }
  double reach() const { return 1.125 * std::sqrt(12.0) * scale(); }

  double number(double size) { return std::uniform_real_distribution<double>(-size, size)(random_); }
  Vector point() { return {number(scale()), number(scale()), number(scale())}; }
  std::size_t one_of(std::size_t count) { return random_() % count; }

  /// Returns a box of any size; some are flat, some are points, some lie at the origin of coordinates.
  Box box() {
    const Vector a = point();
    Vector b = point();
    const double part = std::ldexp(1.0, -int(one_of(60)));
    for (double Vector::*component : kComponents) {
      b.*component = a.*component + (b.*component - a.*component) * part;
      if (one_of(4) == 0) b.*component = a.*component;
    }
    Box box{{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
            {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}};
    for (double Vector::*component : kComponents) {
      if (one_of(6) == 0) box.lower.*component = std::min(0.0, box.upper.*component);
      if (one_of(6) == 0) box.upper.*component = std::max(0.0, box.lower.*component);
    }
    return box;
  }

  /// Returns a ray from anywhere, from a side's plane or from a corner; towards a corner, nearly so or
  /// anywhere; of any length, with some components close to 0.
  Ray ray_for(const Box& box) {
    const auto corner = [&] {
      return Vector{one_of(2) == 0 ? box.lower.x : box.upper.x, one_of(2) == 0 ? box.lower.y : box.upper.y,
                    one_of(2) == 0 ? box.lower.z : box.upper.z};
    };
    Ray ray{one_of(4) == 0 ? corner() : point(), {}};
    for (double Vector::*component : kComponents)
      if (one_of(4) == 0) ray.origin.*component = corner().*component;
    ray.direction = (one_of(3) == 0 ? point() : corner()) - ray.origin;
    for (double Vector::*component : kComponents) {
      if (one_of(6) == 0) ray.direction.*component = corner().*component - ray.origin.*component;
      constexpr double kHardlyAny[] = {0.0, -0.0, 1e-60, -1e-30, 1e-18, -1e-9};
      if (one_of(5) == 0) ray.direction.*component = scale() * kHardlyAny[one_of(std::size(kHardlyAny))];
    }
    if (one_of(3) == 0) {  // beyond its target
      const double off = scale() * std::ldexp(1.0, -int(one_of(40)));
      ray.direction = ray.direction + Vector{number(off), number(off), number(off)};
    }
    if (ray.direction.x == 0 && ray.direction.y == 0 && ray.direction.z == 0) ray.direction.y = scale();
    return {ray.origin, ray.direction * std::ldexp(1.0, int(one_of(80)) - 40)};
  }

  struct Aimed {
    PerPe<Box> boxes;
    PerPe<Ray> rays;
  };
  Aimed aimed() {
    Aimed aimed;
    for (int pe = 0; pe < num_pes(); ++pe) {
      aimed.boxes.push_back(box());
      aimed.rays.push_back(ray_for(aimed.boxes.back()));
    }
    return aimed;
  }

  struct Found {
    PerPe<std::uint64_t> narrow;  ///< entry of the node
    PerPe<double> entry, exit;    ///< by BoxRay
  };
  static constexpr std::uint32_t kReference = 0x0badcafe;

  Found meet(const PerPe<Ray>& rays, const PerPe<Box>& boxes, const PerPe<double>& latest) {
    const double unit = to_node_unit(NodeFormat::fp32, reach());
    PerPe<Vector> origins, directions, lowers, uppers;
    PerPe<float> lower[3], upper[3];
    for (std::size_t pe = 0; pe < rays.size(); ++pe) {
      origins.push_back(rays[pe].origin);
      directions.push_back(rays[pe].direction);
      lowers.push_back(boxes[pe].lower);
      uppers.push_back(boxes[pe].upper);
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis].push_back(rounded_down(boxes[pe].lower.*kComponents[axis] * unit));
        upper[axis].push_back(-rounded_down(-(boxes[pe].upper.*kComponents[axis]) * unit));
      }
    }
    Found found{per_pe<std::uint64_t>(), per_pe<double>(), per_pe<double>()};
    run([&] {
      const path_tracer::Slabs slabs =
          path_tracer::BoxRay(load3(origins), load3(directions)).slabs(load3(lowers), load3(uppers));
      store(found.entry, slabs.entry);
      store(found.exit, slabs.exit);
      const SingleNodeRay ray(load3(origins), load3(directions), unit, load(latest));
      poly<float> entry = 0.0f;
      poly<float> exit = std::numeric_limits<float>::infinity();
      for (int axis = 0; axis < 3; ++axis) {
        const poly<float> below = load(lower[axis]);
        const poly<float> above = load(upper[axis]);
        const auto distance = [](const poly<float>& plane,
                                 const path_tracer::PlaneOperands<float>& operands) {
          return (operands.origin - plane) * operands.scale;
        };
        entry.assign_all_lanes(SingleNodeRay::greater(
            entry, distance(cn::select(ray.backward(axis), above, below), ray.first(axis))));
        exit.assign_all_lanes(SingleNodeRay::lesser(
            exit, distance(cn::select(ray.backward(axis), below, above), ray.last(axis))));
      }
      store(found.narrow, ray.entry_of(entry, exit, kReference));
    });
    return found;
  }

  std::mt19937_64 random_{43};
};

/// Measured in lengths of the direction, as the ray's own entry.
double entry_of(std::uint64_t word, const Ray& ray, double unit) {
  const auto bits = static_cast<std::uint32_t>(word >> 32);
  float entry;
  std::memcpy(&entry, &bits, sizeof(entry));
  const double largest =
      std::max({std::abs(ray.direction.x), std::abs(ray.direction.y), std::abs(ray.direction.z)});
  const double length = std::ldexp(1.0, std::ilogb(largest * 1.4142135623730951));
  return double(entry) / length / unit;
}

/// So a tree of floats gives the same hits as any other.
TEST_P(SingleNodeRayTest, MeetsWhatBoxRayMeetsAndEntersItNoLater) {
  const double unit = to_node_unit(NodeFormat::fp32, reach());
  int met = 0;
  int missed = 0;
  for (int round = 0; round < 60; ++round) {
    const auto [boxes, rays] = aimed();
    const Found found = meet(rays, boxes, per_pe<double>(std::numeric_limits<double>::infinity()));
    for (std::size_t pe = 0; pe < rays.size(); ++pe) {
      const bool is_met = found.narrow[pe] != SingleNodeRay::kNoEntry;
      if (found.entry[pe] > found.exit[pe]) {
        ++missed;
        continue;
      }
      ++met;
      ASSERT_TRUE(is_met) << "entered at " << found.entry[pe] << ", left at " << found.exit[pe];
      ASSERT_EQ(static_cast<std::uint32_t>(found.narrow[pe]), kReference);
      ASSERT_LE(entry_of(found.narrow[pe], rays[pe], unit), found.entry[pe]);
    }
  }
  EXPECT_GT(met, 15000);
  EXPECT_GT(missed, 15000);
}

/// Rounding is below that many units of the node, so a ray that misses a box by more is rejected.
TEST_P(SingleNodeRayTest, MissesWhatIsSomeRoundingsAway) {
  const double margin = 0x1p-18 / to_node_unit(NodeFormat::fp32, reach());
  int missed = 0;
  for (int round = 0; round < 30; ++round) {
    const auto [boxes, rays] = aimed();
    PerPe<Box> larger = boxes;
    for (Box& box : larger)
      for (double Vector::*component : kComponents) {
        box.lower.*component -= margin;
        box.upper.*component += margin;
      }
    const PerPe<double> latest = per_pe<double>(std::numeric_limits<double>::infinity());
    const Found found = meet(rays, boxes, latest);
    const Found around = meet(rays, larger, latest);
    for (std::size_t pe = 0; pe < rays.size(); ++pe) {
      if (around.entry[pe] <= around.exit[pe]) continue;
      ++missed;
      ASSERT_EQ(found.narrow[pe], SingleNodeRay::kNoEntry);
    }
  }
  EXPECT_GT(missed, 5000);
}

/// The limit is rounded, too: a box is met if it is entered at the latest distance that matters.
TEST_P(SingleNodeRayTest, MeetsWhatIsEnteredAtTheLimit) {
  int met = 0;
  int too_late = 0;
  for (int round = 0; round < 30; ++round) {
    const auto [boxes, rays] = aimed();
    const double infinity = std::numeric_limits<double>::infinity();
    const Found unlimited = meet(rays, boxes, per_pe<double>(infinity));
    const Found at_limit = meet(rays, boxes, unlimited.entry);
    PerPe<double> before = unlimited.entry;
    for (double& entry : before) entry *= 0.999;
    const Found before_it = meet(rays, boxes, before);
    for (std::size_t pe = 0; pe < rays.size(); ++pe) {
      if (unlimited.entry[pe] > unlimited.exit[pe]) continue;
      ++met;
      ASSERT_NE(at_limit.narrow[pe], SingleNodeRay::kNoEntry);
      too_late += before_it.narrow[pe] == SingleNodeRay::kNoEntry;
    }
  }
  EXPECT_GT(met, 7000);
  EXPECT_GT(too_late, met / 4);
}

INSTANTIATE_TEST_SUITE_P(Scales, SingleNodeRayTest, testing::Values(1e-150, 1e-70, 1e-5, 1.0, 1e7, 1e100));

TEST(SingleNodeRayUnit, HasTheReachBetweenOneAndTwo) {
  for (const double reach : {1e-300, 0.1, 1.0, 1.999, 2.0, 3e5, 1e300}) {
    const double unit = to_node_unit(NodeFormat::fp32, reach);
    EXPECT_GE(reach * unit, 1.0) << reach;
    EXPECT_LT(reach * unit, 2.0) << reach;
    int exponent = 0;
    EXPECT_EQ(std::frexp(unit, &exponent), 0.5);
    EXPECT_EQ(to_node_unit(NodeFormat::quantised8, reach), unit);
    EXPECT_EQ(to_node_unit(NodeFormat::fp64, reach), 1.0);
  }
  EXPECT_EQ(to_node_unit(NodeFormat::fp32, 0.0), 1.0);
  EXPECT_EQ(to_node_unit(NodeFormat::fp32, 1e-320), 0x1p1000) << "and finite";
}

}  // namespace node_ray_test
