#include "firmware/path_tracer/geometry/box.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/vectors.hpp"

namespace box_test {

using cn::poly;
using cn::vec3;
using test_support::kComponents;
using test_support::load;
using test_support::load3;
using test_support::PerPe;
using test_support::Ray;
using test_support::store;
using test_support::Vector;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Box {
  Vector lower;
  Vector upper;
};

class BoxTest : public test_support::StripFixture {
 protected:
  BoxTest() : StripFixture(1024) {}

  struct Found {
    PerPe<double> entry;
    PerPe<double> exit;
    bool met(std::size_t pe) const { return entry[pe] <= exit[pe]; }
  };

  /// One ray and one box for each PE.
  Found slabs(const PerPe<Ray>& rays, const PerPe<Box>& boxes) {
    PerPe<Vector> origins, directions, lowers, uppers;
    for (const Ray& ray : rays) {
      origins.push_back(ray.origin);
      directions.push_back(ray.direction);
    }
    for (const Box& box : boxes) {
      lowers.push_back(box.lower);
      uppers.push_back(box.upper);
    }
    Found found{per_pe<double>(), per_pe<double>()};
    run([&] {
      const path_tracer::BoxRay ray(load3(origins), load3(directions));
      const path_tracer::Slabs slabs = ray.slabs(load3(lowers), load3(uppers));
      store(found.entry, slabs.entry);
      store(found.exit, slabs.exit);
    });
    return found;
  }

  bool meets(const Ray& ray, const Box& box) {
    return slabs(PerPe<Ray>(std::size_t(num_pes()), ray), PerPe<Box>(std::size_t(num_pes()), box)).met(0);
  }

  double number(double scale) { return std::uniform_real_distribution<double>(-scale, scale)(random_); }
  Vector point(double scale) { return {number(scale), number(scale), number(scale)}; }
  std::size_t one_of(std::size_t count) { return random_() % count; }

  Box around(const Vector& a, const Vector& b) {
    return {{std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)},
            {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}};
  }
  /// Returns a random box, a flat one or a point.
  Box inner_box(double scale) {
    Box box = around(point(scale), point(scale));
    for (double Vector::*component : kComponents)
      if (one_of(4) == 0) box.upper.*component = box.lower.*component;
    return box;
  }
  /// Returns a box around another: each side is the inner one's, the next double, far out, or what fp32 makes
  /// of large numbers.
  Box outer_box(const Box& inner, double scale) {
    Box outer = inner;
    for (double Vector::*component : kComponents) {
      const auto outwards = [&](double side, double towards) {
        switch (one_of(5)) {
          case 0:
            return side;
          case 1:
            return std::nextafter(side, towards);
          case 2:
            return towards;
          default:
            return side + std::copysign(std::abs(number(scale)), towards);
        }
      };
      outer.lower.*component = outwards(inner.lower.*component, -kInfinity);
      outer.upper.*component = outwards(inner.upper.*component, kInfinity);
    }
    return outer;
  }
  /// Returns a ray from anywhere or from a side's plane; towards anywhere or a corner, or with some
  /// components close to 0.
  Ray ray_for(const Box& box, double scale) {
    Ray ray{point(2 * scale), point(1.0)};
    if (one_of(2) == 0) {
      const Vector corner{one_of(2) == 0 ? box.lower.x : box.upper.x,
                          one_of(2) == 0 ? box.lower.y : box.upper.y,
                          one_of(2) == 0 ? box.lower.z : box.upper.z};
      ray.direction = (corner - ray.origin) * (1 / scale);
    }
    for (double Vector::*component : kComponents) {
      if (one_of(4) == 0) ray.origin.*component = (one_of(2) == 0 ? box.lower : box.upper).*component;
      constexpr double kHardlyAny[] = {0.0, -0.0, 0x1p-1074, -0x1p-1030, 1e-300, -1e-200, 1e-30};
      if (one_of(4) == 0) ray.direction.*component = kHardlyAny[one_of(std::size(kHardlyAny))];
    }
    return ray;
  }

  std::mt19937_64 random_{41};
};

/// The tree asks no more of the test, and it must hold to the last bit.
TEST_F(BoxTest, ARayThatMeetsABoxMeetsEveryBoxAroundItAndEntersThatNoLater) {
  int met = 0;
  int missed = 0;
  for (const double scale : {1e-70, 1e-3, 1.0, 1e5, 1e100}) {
    for (int round = 0; round < 60; ++round) {
      PerPe<Box> inner, outer;
      PerPe<Ray> rays;
      for (int pe = 0; pe < num_pes(); ++pe) {
        inner.push_back(inner_box(scale));
        outer.push_back(outer_box(inner.back(), scale));
        rays.push_back(ray_for(inner.back(), scale));
      }
      const Found in = slabs(rays, inner);
      const Found out = slabs(rays, outer);
      for (std::size_t pe = 0; pe < rays.size(); ++pe) {
        ++(in.met(pe) ? met : missed);
        if (!in.met(pe)) continue;
        ASSERT_TRUE(out.met(pe));
        ASSERT_LE(out.entry[pe], in.entry[pe]);
      }
    }
  }
  EXPECT_GT(met, 20000);
  EXPECT_GT(missed, 20000);
}

/// Keeps a distance from cases that rounding decides.
TEST_F(BoxTest, TheSlabsAreWhereTheRayIsInTheBox) {
  int met = 0;
  for (int round = 0; round < 80; ++round) {
    PerPe<Box> boxes;
    PerPe<Ray> rays;
    for (int pe = 0; pe < num_pes(); ++pe) {
      boxes.push_back(around(point(1.0), point(1.0)));
      rays.push_back({point(2.0), point(1.0)});
    }
    const Found found = slabs(rays, boxes);
    for (std::size_t pe = 0; pe < rays.size(); ++pe) {
      long double entry = 0;
      long double exit = kInfinity;
      for (double Vector::*component : kComponents) {
        const long double direction = rays[pe].direction.*component;
        const long double a =
            (boxes[pe].lower.*component - static_cast<long double>(rays[pe].origin.*component)) / direction;
        const long double b =
            (boxes[pe].upper.*component - static_cast<long double>(rays[pe].origin.*component)) / direction;
        entry = std::max(entry, std::min(a, b));
        exit = std::min(exit, std::max(a, b));
      }
      if (std::abs(entry - exit) < 1e-9 * std::abs(exit)) continue;
      ASSERT_EQ(found.met(pe), entry <= exit);
      if (entry > exit) continue;
      ++met;
      ASSERT_NEAR(found.entry[pe], double(entry), 1e-12 * double(entry));
      ASSERT_NEAR(found.exit[pe], double(exit), 1e-12 * double(exit));
    }
  }
  EXPECT_GT(met, 2000);
}

/// Keys of nodes are the upper halves of entries as integers, of which -0 would be the largest.
TEST_F(BoxTest, FromWithinAndFromTheSidesTheEntryIsPlusZero) {
  const Box unit{{-1, -1, -1}, {1, 1, 1}};
  PerPe<Ray> rays;
  for (const double x : {-1.0, 0.0, 1.0})
    for (const double y : {-1.0, -0.0, 1.0})
      for (const double z : {-1.0, 0.0, 1.0})
        for (const double dx : {-1.0, -0.0, 0.0, 1.0})
          for (const double dy : {-1.0, 0.0}) rays.push_back({{x, y, z}, {dx, dy, z > 0 ? -1.0 : 1.0}});
  rays.resize(std::size_t(num_pes()), {{0, 0, 0}, {0, 0, 1}});
  const Found found = slabs(rays, PerPe<Box>(rays.size(), unit));
  for (std::size_t pe = 0; pe < rays.size(); ++pe) {
    EXPECT_TRUE(found.met(pe)) << pe;
    EXPECT_EQ(found.entry[pe], 0.0) << pe;
    EXPECT_FALSE(std::signbit(found.entry[pe])) << pe;
  }
}

/// On a side's plane itself either answer is right, because boxes of triangles are padded.
TEST_F(BoxTest, ComponentsOfZeroMeetWhatTheyPassBetween) {
  const Box flat{{0, 0, -1e-12}, {1, 1, 1e-12}};
  const Ray hits[] = {{{0.5, 0.5, -1}, {0, 0, 1}},                // through it
                      {{1 - 1e-16, 1e-100, -1}, {0.0, -0.0, 1}},  // close to a corner
                      {{1e-100, 1 - 1e-16, 1}, {-0.0, 0.0, -1}},
                      {{-1, 0.5, 0}, {1, 0, 0}},  // within its thickness
                      {{0.5, 2, 0}, {-0.0, -1, -0.0}}};
  for (const Ray& ray : hits) EXPECT_TRUE(meets(ray, flat)) << &ray - hits;
  const Ray misses[] = {{{1 + 1e-15, 0.5, -1}, {0, 0, 1}},  // beside it
                        {{-1e-100, 0.5, -1}, {-0.0, 0, 1}},
                        {{-1, 0.5, 1e-9}, {1, -0.0, 0}},  // above it
                        {{0.5, 0.5, -1}, {0, 0, -1}}};    // away from it
  for (const Ray& ray : misses) EXPECT_FALSE(meets(ray, flat)) << &ray - misses;
}

/// The result is at most two units in the last place from the exact quotient.
TEST_F(BoxTest, TheLatestEntryIsNotBeforeTheExactDistance) {
  PerPe<double> numerators = per_pe<double>();
  PerPe<double> sizes = per_pe<double>();
  for (std::size_t pe = 0; pe < sizes.size(); ++pe) {
    numerators[pe] = std::abs(number(1e3));
    sizes[pe] = std::abs(number(1e-3)) + 1e-9;
  }
  PerPe<double> latest = per_pe<double>();
  run([&] { store(latest, path_tracer::latest_entry(load(numerators) / load(sizes))); });
  for (std::size_t pe = 0; pe < sizes.size(); ++pe) {
    const long double exact = static_cast<long double>(numerators[pe]) / sizes[pe];
    EXPECT_GT(latest[pe], exact);
    EXPECT_LT(latest[pe], exact * (1 + 0x1p-48L));
  }
}

}  // namespace box_test
