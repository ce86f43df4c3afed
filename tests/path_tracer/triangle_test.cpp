#include "firmware/path_tracer/geometry/triangle.hpp"

#include <cmath>
#include <random>

#include "tests/support/strip_fixture.hpp"

namespace triangle_test {

using cn::InstructionClass;
using cn::poly;
using path_tracer::kNoFace;
using path_tracer::TriangleRecord;
using test_support::load;
using test_support::PerPe;
using test_support::store;

using Vector = cn::vec3<double>;
using Exact = cn::vec3<long double>;  // 11 bits more than the kernels have

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Exact exact(const Vector& v) {
  return {v.x, v.y, v.z};
}

/// A triangle as the scene has it.
struct Shape {
  Vector vertex;
  Vector edge1;
  Vector edge2;
  int face;
};

Shape triangle(const Vector& a, const Vector& b, const Vector& c, int face = 0) {
  return {a, b - a, c - a, face};
}

constexpr double kReach = 1e4;  // enough for all triangles that are not scaled

/// Makes records, numbered in their order.
std::vector<TriangleRecord> records(const std::vector<Shape>& shapes, double reach = kReach) {
  std::vector<TriangleRecord> records;
  for (const Shape& shape : shapes)
    records.push_back(path_tracer::triangle_record(shape.vertex, shape.edge1, shape.edge2,
                                                   {shape.face, std::int32_t(records.size()), reach}));
  return records;
}

struct Ray {
  Vector origin;
  Vector direction;
};

/// Where a line meets the plane of a triangle, and its margin to the border of acceptance (relative;
/// negative: missed).
struct Meeting {
  long double distance = 0;
  long double margin = 0;
  bool front = false;
};

Meeting meet(const Ray& ray, const Shape& t) {
  const Exact edge1 = exact(t.edge1);
  const Exact edge2 = exact(t.edge2);
  const Exact direction = exact(ray.direction);
  const Exact s = exact(ray.origin) - exact(t.vertex);
  const Exact normal = cross(edge1, edge2);
  const long double determinant = -dot(normal, direction);
  const long double u = dot(cross(edge2, s), direction) / determinant;  // by Cramer's rule, in another order
  const long double v = dot(cross(s, edge1), direction) / determinant;
  Meeting meeting;
  meeting.distance = dot(normal, s) / determinant;
  const long double size = std::sqrt(dot(s, s)) / std::sqrt(dot(direction, direction));
  meeting.margin = std::min({u, v, 1 - u - v, meeting.distance / size});
  meeting.front = determinant > 0;
  return meeting;
}

class TriangleTest : public test_support::StripFixture {
 protected:
  TriangleTest() : StripFixture(256) {}

  struct Hits {
    PerPe<std::int32_t> triangle;
    PerPe<double> distance;
    PerPe<double> determinant;
  };

  static cn::vec3<poly<double>> load3(const std::vector<Ray>& rays, Vector Ray::*member) {
    PerPe<double> x;
    PerPe<double> y;
    PerPe<double> z;
    for (const Ray& ray : rays) {
      x.push_back((ray.*member).x);
      y.push_back((ray.*member).y);
      z.push_back((ray.*member).z);
    }
    return {load(x), load(y), load(z)};
  }
  std::vector<Ray> on_all_pes(std::vector<Ray> rays) const {
    rays.resize(std::size_t(num_pes()), rays.empty() ? Ray{} : rays.back());
    return rays;
  }

  Hits nearest(const std::vector<Ray>& some_rays, const std::vector<TriangleRecord>& triangles,
               double reach = kReach, int left_face = kNoFace) {
    const std::vector<Ray> rays = on_all_pes(some_rays);
    Hits hits{per_pe<std::int32_t>(), per_pe<double>(), per_pe<double>()};
    run([&] {
      const path_tracer::RayOperands ray{load3(rays, &Ray::origin), load3(rays, &Ray::direction), left_face};
      path_tracer::Nearest found;
      search(ray, reach, path_tracer::MonoTriangles{triangles.data(), int(triangles.size())}, found);
      store(hits.triangle, found.number);
      store(hits.distance, found.distance / cn::abs(found.determinant));
      store(hits.determinant, found.determinant);
    });
    return hits;
  }
  int nearest_one(const Ray& ray, const std::vector<TriangleRecord>& triangles, int left_face = kNoFace) {
    return nearest({ray}, triangles, kReach, left_face).triangle[0];
  }
  int nearest_one(const Ray& ray, const std::vector<Shape>& triangles, int left_face = kNoFace) {
    return nearest_one(ray, records(triangles), left_face);
  }

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_() >> 11) * 0x1p-53);
  }
  Vector point(double scale) {
    return {uniform(-scale, scale), uniform(-scale, scale), uniform(-scale, scale)};
  }
  Vector unit_vector() {
    while (true) {
      const Vector v = point(1.0);
      const double length = std::sqrt(dot(v, v));
      if (length > 0.1 && length < 1) return v * (1 / length);
    }
  }

  std::mt19937_64 random_{31};
};

const Shape kUnit = triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});  // its front looks along +z

TEST_F(TriangleTest, AgreesWithTheExactNearestHitAtAnyScale) {
  for (const double scale : {1e-8, 1e-3, 1.0, 1e5, 1e8}) {
    SCOPED_TRACE(scale);
    int hits = 0;
    int misses = 0;
    for (int round = 0; round < 20; ++round) {
      std::vector<Shape> triangles;
      for (int i = 0; i < 24; ++i) triangles.push_back(triangle(point(scale), point(scale), point(scale), i));
      std::vector<Ray> rays;
      for (int pe = 0; pe < num_pes(); ++pe) rays.push_back({point(scale), unit_vector()});
      const double reach = 4 * scale;
      const Hits found = nearest(rays, records(triangles, reach), reach);
      for (std::size_t pe = 0; pe < rays.size(); ++pe) {
        int expected = -1;
        Meeting nearest_meeting;
        bool too_close_to_call = false;
        for (std::size_t i = 0; i < triangles.size(); ++i) {
          const Meeting meeting = meet(rays[pe], triangles[i]);
          too_close_to_call |= std::abs(meeting.margin) < 1e-9;
          if (meeting.margin <= 0 || (expected >= 0 && meeting.distance >= nearest_meeting.distance))
            continue;
          expected = int(i);
          nearest_meeting = meeting;
        }
        if (too_close_to_call) continue;
        ASSERT_EQ(found.triangle[pe], expected);
        ++(expected >= 0 ? hits : misses);
        if (expected < 0) continue;
        ASSERT_NEAR(found.distance[pe] / double(nearest_meeting.distance), 1.0, 1e-9);
        ASSERT_EQ(found.determinant[pe] > 0, nearest_meeting.front);
      }
    }
    EXPECT_GT(hits, 1000);
    EXPECT_GT(misses, 1000);
  }
}

/// A shadow ray is as long as the distance to its light: it hits its light unless something is nearer.
TEST_F(TriangleTest, ShadowRaysHitTheLightUnlessTheExactBlockersAreNearer) {
  constexpr int kLight = 3;
  for (const double scale : {1e-8, 1.0, 1e8}) {
    SCOPED_TRACE(scale);
    int counts[2] = {0, 0};
    for (int round = 0; round < 600; ++round) {
      std::vector<Shape> triangles;
      for (int i = 0; i < 4; ++i) triangles.push_back(triangle(point(scale), point(scale), point(scale), i));
      const Shape& light = triangles[kLight];
      const double u = uniform(0.01, 0.49);
      const double v = uniform(0.01, 0.49);
      const Vector from = point(scale);
      const Ray ray{from, light.vertex + light.edge1 * u + light.edge2 * v - from};
      bool blocked = false;
      bool too_close_to_call = std::abs(meet(ray, light).margin) < 1e-9;
      for (int i = 0; i < kLight; ++i) {
        const Meeting meeting = meet(ray, triangles[std::size_t(i)]);
        const long double margin = std::min(meeting.margin, 1 - meeting.distance);
        too_close_to_call |= std::abs(margin) < 1e-9;
        blocked |= margin > 0;
      }
      if (too_close_to_call) continue;
      const double reach = 4 * scale;
      const Hits found = nearest({ray}, records(triangles, reach), reach);
      ASSERT_EQ(found.triangle[0] == kLight, !blocked);
      ++counts[blocked];
    }
    EXPECT_GT(counts[0], 100);
    EXPECT_GT(counts[1], 50);
  }
}

/// The distance is measured in lengths of the direction.
TEST_F(TriangleTest, DirectionsNeedNotBeOfUnitLength) {
  for (const double length : {0x1p-30, 0.5, 3.0, 0x1p30}) {
    const Hits hits = nearest({{{0.25, 0.25, 2}, {0, 0, -length}}}, records({kUnit}));
    EXPECT_EQ(hits.triangle[0], 0) << length;
    EXPECT_EQ(hits.distance[0], 2 / length);
  }
}

TEST_F(TriangleTest, EdgesAndVerticesBelongToTheTriangle) {
  for (const Vector& to :
       {Vector{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.5, 0, 0}, {0, 0.25, 0}, {0.5, 0.5, 0}, {0.75, 0.25, 0}}) {
    EXPECT_EQ(nearest_one({{to.x, to.y, 2}, {0, 0, -1}}, {kUnit}), 0) << to.x << " " << to.y;
    EXPECT_EQ(nearest_one({{to.x, to.y, -2}, {0, 0, 1}}, {kUnit}), 0) << to.x << " " << to.y;
  }
  const double out = 0x1p-40;
  for (const Vector& to :
       {Vector{-out, 0.5, 0}, {0.5, -out, 0}, {0.5 + out, 0.5, 0}, {1 + out, 0, 0}, {0, 1 + out, 0}}) {
    EXPECT_EQ(nearest_one({{to.x, to.y, 2}, {0, 0, -1}}, {kUnit}), -1) << to.x << " " << to.y;
    EXPECT_EQ(nearest_one({{to.x, to.y, -2}, {0, 0, 1}}, {kUnit}), -1) << to.x << " " << to.y;
  }
}

TEST_F(TriangleTest, FrontAndBackAreToldApart) {
  const Hits front = nearest({{{0.25, 0.25, 2}, {0, 0, -1}}}, records({kUnit}));
  EXPECT_EQ(front.triangle[0], 0);
  EXPECT_GT(front.determinant[0], 0);
  EXPECT_EQ(front.distance[0], 2.0);
  const Hits back = nearest({{{0.25, 0.25, -3}, {0, 0, 1}}}, records({kUnit}));
  EXPECT_EQ(back.triangle[0], 0);
  EXPECT_LT(back.determinant[0], 0);
  EXPECT_EQ(back.distance[0], 3.0);
}

TEST_F(TriangleTest, OnlyWhatIsAheadCounts) {
  EXPECT_EQ(nearest_one({{0.25, 0.25, 2}, {0, 0, 1}}, {kUnit}), -1);
  EXPECT_EQ(nearest_one({{0.25, 0.25, 0}, {0, 0, 1}}, {kUnit}), -1) << "the origin lies on it";
  EXPECT_EQ(nearest_one({{0.25, 0.25, 0x1p-60}, {0, 0, -1}}, {kUnit}), 0);
}

TEST_F(TriangleTest, ParallelRaysMiss) {
  for (const Vector& direction : {Vector{1, 0, 0}, {0, -1, 0}, {0.5, 0.25, 0}, {-1, 1, 0}}) {
    for (const Vector& origin :
         {Vector{-2, 0.25, 0}, {0.25, 0.25, 0}, {0, 0, 0}, {0.25, 2, 0}, {0.25, 0.25, 1}, {0, 0, -1}}) {
      EXPECT_EQ(nearest_one({origin, direction}, {kUnit}), -1);
      // They do not hide other hits either.
      const Shape wall =
          triangle({origin + direction * 4 + Vector{-9, -9, -9}}, origin + direction * 4 + Vector{9, -9, 9},
                   origin + direction * 4 + Vector{0, 9, 0}, 1);
      EXPECT_EQ(nearest_one({origin, direction}, {kUnit, wall}),
                nearest_one({origin, direction}, {wall}) < 0 ? -1 : 1);
    }
  }
}

TEST_F(TriangleTest, TrianglesWithoutAreaAreNeverHit) {
  const std::vector<Shape> degenerate{
      triangle({0, 0, 0}, {0, 0, 0}, {0, 0, 0}),                      // a point
      triangle({-1, -1, 0}, {1, 1, 0}, {3, 3, 0}),                    // a line
      triangle({0.1, 0.2, 0.3}, {0.4, -0.5, 0.7}, {0.4, -0.5, 0.7}),  // two equal vertices
      triangle({0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}, {0.4, -0.5, 0.7})};
  std::vector<Shape> with_wall = degenerate;
  with_wall.push_back(triangle({-1e3, -1e3, -5}, {3e3, -1e3, -5}, {-1e3, 3e3, -5}, 1));
  std::vector<Ray> rays{{{0, 0, 2}, {0, 0, -1}}, {{0.5, 0.5, 2}, {0, 0, -1}}, {{-2, -2, 0}, {1, 1, 0}}};
  while (rays.size() < std::size_t(num_pes())) {
    const Vector origin{uniform(-2, 2), uniform(-2, 2), 2};
    rays.push_back({origin, Vector{uniform(-1, 1), uniform(-1, 1), -0.5} - origin});
  }
  const Hits nothing = nearest(rays, records(degenerate));
  const Hits wall = nearest(rays, records(with_wall));
  for (std::size_t pe = 0; pe < rays.size(); ++pe) {
    EXPECT_EQ(nothing.triangle[pe], -1) << pe;
    EXPECT_EQ(wall.triangle[pe], rays[pe].direction.z < 0 ? 4 : -1) << pe;
  }
}

TEST_F(TriangleTest, ARayIgnoresTheFaceThatItLeaves) {
  const std::vector<Shape> triangles{triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 5),
                                     triangle({0, 0, -1}, {1, 0, -1}, {0, 1, -1}, 5),
                                     triangle({0, 0, -2}, {1, 0, -2}, {0, 1, -2}, 6)};
  const Ray ray{{0.25, 0.25, 1}, {0, 0, -1}};
  EXPECT_EQ(nearest_one(ray, triangles), 0);
  EXPECT_EQ(nearest_one(ray, triangles, 5), 2);
  EXPECT_EQ(nearest_one(ray, triangles, 6), 0);
}

TEST_F(TriangleTest, NanNeverWins) {
  const std::vector<TriangleRecord> both =
      records({kUnit, triangle({-9, -9, -1}, {9, -9, -1}, {0, 9, -1}, 1)});
  const Ray good{{0.25, 0.25, 1}, {0, 0, -1}};
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (double Vector::*component : {&Vector::x, &Vector::y, &Vector::z}) {
      for (Vector TriangleRecord::*member :
           {&TriangleRecord::vertex, &TriangleRecord::edge1, &TriangleRecord::edge2, &TriangleRecord::back}) {
        TriangleRecord broken = both[0];
        broken.*member.*component = bad;
        EXPECT_EQ(nearest_one(good, std::vector{broken, both[1]}), 1) << bad;
        EXPECT_EQ(nearest_one(good, std::vector{both[1], broken}), 1) << bad;
      }
      for (Vector Ray::*member : {&Ray::origin, &Ray::direction}) {
        Ray broken = good;
        broken.*member.*component = bad;
        const Hits hits = nearest({good, broken, good}, both);
        EXPECT_EQ(hits.triangle[0], 0);
        EXPECT_EQ(hits.triangle[1], -1) << bad;
        EXPECT_EQ(hits.triangle[2], 0);
      }
    }
  }
}

TEST_F(TriangleTest, EqualDistancesGoToTheLowestNumber) {
  const Ray ray{{0.25, 0.25, 2}, {0, 0, -1}};
  std::vector<TriangleRecord> three = records({kUnit, kUnit, kUnit});
  EXPECT_EQ(nearest_one(ray, three), 0);
  std::rotate(three.begin(), three.begin() + 1, three.end());
  EXPECT_EQ(nearest_one(ray, three), 0);
  std::rotate(three.begin(), three.begin() + 1, three.end());
  EXPECT_EQ(nearest_one(ray, three), 0);
}

TEST_F(TriangleTest, NothingIsInfinitelyFar) {
  const Hits hits = nearest({{{0.25, 0.25, 2}, {0, 0, -1}}}, records({}));
  EXPECT_EQ(hits.triangle[0], -1);
  EXPECT_EQ(hits.distance[0], kInfinity);
}

/// A search may start from the result of an earlier one.
TEST_F(TriangleTest, SearchesGoOnWhereOthersEnded) {
  const std::vector<TriangleRecord> triangles = records({kUnit, triangle({0, 0, 1}, {1, 0, 1}, {0, 1, 1})});
  PerPe<std::int32_t> found = per_pe<std::int32_t>();
  run([&] {
    const path_tracer::RayOperands ray{{0.25, 0.25, 2.0}, {0.0, 0.0, -1.0}, kNoFace};
    path_tracer::Nearest nearest;
    for (const int first : {1, 0})
      search(ray, kReach, path_tracer::MonoTriangles{&triangles[std::size_t(first)], 1}, nearest);
    store(found, nearest.number);
  });
  EXPECT_EQ(found, per_pe(1));
}

/// Cost is the same for rays that hit and rays that miss; only ties and hits that rounding decides cost more.
TEST_F(TriangleTest, IssuesTheSameForEveryRayWithoutTies) {
  const std::vector<TriangleRecord> two = records({kUnit, triangle({0, 0, 1}, {1, 0, 1}, {0, 1, 1})});
  ASSERT_EQ(nearest({{{0.25, 0.25, 2}, {0, 0, -1}}}, two).triangle[0], 1);
  const cn::IssueCounts hit = issue_tree.total();
  ASSERT_EQ(nearest({{{5, 5, 2}, {0, 0, 1}}}, two).triangle[0], -1);
  EXPECT_EQ(issue_tree.total(), hit);
  EXPECT_EQ(hit[InstructionClass::mono], 2 * 16u);
  EXPECT_EQ(hit[InstructionClass::fp64_mul], 2 * 20u);
  nearest({{{0.25, 0.25, 2}, {0, 0, -1}}}, records({kUnit, kUnit}));
  EXPECT_GT(issue_tree.total()[InstructionClass::fp64_mul], hit[InstructionClass::fp64_mul]);
}

}  // namespace triangle_test
