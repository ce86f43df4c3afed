#include "firmware/path_tracer/prefilter/prefilter_ray.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "tests/support/vectors.hpp"

namespace prefilter_ray_test {

using path_tracer::Crossing;
using path_tracer::Prefilter;
using path_tracer::PrefilterRay;
using path_tracer::RayOperands;
using path_tracer::TriangleRecord;
using test_support::kComponents;
using test_support::load;
using test_support::load3;
using test_support::PerPe;
using test_support::Ray;
using test_support::Vector;

/// A scene of triangles and rays of that size, around a point that far from the origin of coordinates.
struct Place {
  double scale;
  double offset;
};

class PrefilterRayTest : public test_support::StripFixture, public testing::WithParamInterface<Place> {
 protected:
  PrefilterRayTest() : StripFixture(512) {}

  double number(double size) { return std::uniform_real_distribution<double>(-size, size)(random_); }
  std::size_t one_of(std::size_t count) { return random_() % count; }
  double scale() const { return GetParam().scale; }
  Vector middle() const { return Vector{1.0, -0.7, 0.3} * GetParam().offset; }
  Vector point() { return middle() + Vector{number(scale()), number(scale()), number(scale())}; }
  double reach() const { return 1.125 * std::sqrt(12.0) * scale(); }

  /// Returns a triangle of any size and shape.
  TriangleRecord triangle(int number_in_scene) {
    const Vector vertex = point();
    Vector edge1 = (point() - vertex) * std::ldexp(1.0, -int(one_of(12)));
    Vector edge2 = (point() - vertex) * std::ldexp(1.0, -int(one_of(12)));
    if (one_of(4) == 0) edge2 = edge1 * number(1) + edge2 * std::ldexp(1.0, -int(one_of(30)));  // a sliver
    for (double Vector::*component : kComponents)
      if (one_of(6) == 0) edge1.*component = edge2.*component = 0.0;
    return path_tracer::triangle_record(vertex, edge1, edge2,
                                        {number_in_scene % 5, number_in_scene, reach()});
  }
  std::vector<TriangleRecord> triangles(int count) {
    std::vector<TriangleRecord> triangles;
    for (int i = 0; i < count; ++i) triangles.push_back(triangle(i));
    return triangles;
  }

  /// The record's edges are scaled by a power of two, and `back` by the same.
  static Vector edge(const TriangleRecord& triangle, const Vector& scaled) {
    const Vector product = cross(triangle.edge2, triangle.edge1);
    return scaled * (dot(triangle.back, triangle.back) / dot(product, triangle.back));
  }
  /// Returns a point of the triangle's plane; on the triangle if a and b are 0 to 1 and their sum is at most
  /// 1.
  Vector on(const TriangleRecord& triangle, double a, double b) {
    return triangle.vertex + edge(triangle, triangle.edge1) * a + edge(triangle, triangle.edge2) * b;
  }

  /// Returns a ray towards the triangle, its border, a corner or just past them; from anywhere, from its
  /// plane or from behind it.
  Ray ray_for(const TriangleRecord& triangle) {
    double a = number(0.5) + 0.5;
    double b = (1 - a) * (number(0.5) + 0.5);
    if (one_of(3) == 0) a = 0;
    if (one_of(3) == 0) b = 1 - a;
    if (one_of(6) == 0) b = 0;
    if (one_of(3) == 0) a += number(std::ldexp(1.0, -int(one_of(50))));
    Ray ray{point(), {}};
    if (one_of(6) == 0) ray.origin = on(triangle, number(2), number(2));
    if (one_of(8) == 0) ray.origin = triangle.vertex;
    for (double Vector::*component : kComponents) {  // within the scene
      const double center = middle().*component;
      ray.origin.*component = std::clamp(ray.origin.*component, center - scale(), center + scale());
    }
    ray.direction = on(triangle, a, b) - ray.origin;
    if (one_of(8) == 0) ray.direction = ray.direction * -1.0;
    for (double Vector::*component : kComponents)
      if (one_of(10) == 0) ray.direction.*component = one_of(2) == 0 ? 0.0 : scale() * 1e-18;
    if (ray.direction.x == 0 && ray.direction.y == 0 && ray.direction.z == 0) ray.direction.z = scale();
    return {ray.origin, ray.direction * std::ldexp(1.0, int(one_of(50)) - 10)};
  }

  struct Found {
    int crossings = 0;  ///< found by the triangle's test
    int may_cross = 0;  ///< found by the prefilter
    int wrong = 0;      ///< crossings that the prefilter rules out
  };
  /// Tests each PE's ray against each triangle.
  Found ask(const std::vector<Ray>& rays, const std::vector<TriangleRecord>& triangles) {
    PerPe<Vector> origins, directions;
    for (const Ray& ray : rays) {
      origins.push_back(ray.origin);
      directions.push_back(ray.direction);
    }
    const PerPe<std::int32_t> left_faces = per_pe<std::int32_t>(2);
    const Prefilter prefilter = path_tracer::make_prefilter(triangles.data(), int(triangles.size()), reach());
    Found found;
    run([&] {
      const RayOperands ray{load3(origins), load3(directions), load(left_faces)};
      const PrefilterRay prefilter_ray(ray, prefilter);
      for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Crossing crossing(ray, triangles[i]);
        const auto crosses = mask_bits(
            (crossing.inside & (ray.left_face != cn::poly<std::int32_t>(triangles[i].face))).lanes());
        const unsigned may_cross = prefilter_ray.may_cross(prefilter.triangles[i]);
        found.crossings += __builtin_popcount(crosses);
        found.may_cross += __builtin_popcount(may_cross);
        found.wrong +=
            __builtin_popcount(path_tracer::prefilter_detail::in_order_of_floats(crosses) & ~may_cross);
      }
    });
    return found;
  }

  std::mt19937_64 random_{7};
};

TEST_P(PrefilterRayTest, LetsNoCrossingSlip) {
  Found all;
  for (int batch = 0; batch < 60; ++batch) {
    const std::vector<TriangleRecord> triangles = this->triangles(24);
    std::vector<Ray> rays;
    for (int pe = 0; pe < num_pes(); ++pe) rays.push_back(ray_for(triangles[one_of(triangles.size())]));
    const Found found = ask(rays, triangles);
    all.crossings += found.crossings;
    all.wrong += found.wrong;
  }
  EXPECT_EQ(all.wrong, 0);
  EXPECT_GT(all.crossings, 5000);
}

/// Triangles as large as the scene, not seen edge on: rays that miss by a thousandth are left out.
TEST_P(PrefilterRayTest, LeavesOutWhatPassesBy) {
  const double past = 1 + std::ldexp(1.0, -10);
  for (int batch = 0; batch < 20; ++batch) {
    const Vector vertex = middle() + Vector{number(0.1), number(0.1), number(0.1)} * scale();
    const TriangleRecord triangle =
        path_tracer::triangle_record(vertex, Vector{0.8, number(0.1), 0} * scale(),
                                     Vector{number(0.1), 0.8, 0} * scale(), {0, 0, reach()});
    std::vector<Ray> rays;
    for (int pe = 0; pe < num_pes(); ++pe) {
      const double a = 0.5 + number(0.5);
      const Vector outside[] = {on(triangle, a, past - a), on(triangle, a, 1 - past),
                                on(triangle, 1 - past, a)};
      const Vector origin = middle() + Vector{number(1), number(1), one_of(2) == 0 ? 0.9 : -0.9} * scale();
      const Vector behind = origin + (origin - on(triangle, a, 0.5 * (1 - a)));
      rays.push_back({origin, (one_of(4) == 0 ? behind : outside[one_of(3)]) - origin});
    }
    const Found found = ask(rays, {triangle});
    EXPECT_EQ(found.crossings, 0);
    EXPECT_EQ(found.may_cross, 0);
  }
}

/// Rays all over the scene, as in a render: hardly more triangles are let through than are crossed.
TEST_P(PrefilterRayTest, LeavesOutNearlyAllThatIsNotCrossed) {
  const auto half_way = [&] { return (point() - middle()) * 0.5; };
  std::vector<TriangleRecord> triangles;
  for (int i = 0; i < 40; ++i)
    triangles.push_back(
        path_tracer::triangle_record(middle() + half_way(), half_way(), half_way(), {0, i, reach()}));
  std::vector<Ray> rays;
  for (int pe = 0; pe < num_pes(); ++pe) {
    const Vector origin = point();
    rays.push_back({origin, point() - origin});
  }
  const Found found = ask(rays, triangles);
  EXPECT_EQ(found.wrong, 0);
  EXPECT_GT(found.crossings, 300);
  EXPECT_LT(found.may_cross, 1.02 * found.crossings + 20);
}

TEST_P(PrefilterRayTest, LeavesOutTheFaceThatTheRayLeaves) {
  TriangleRecord triangle = path_tracer::triangle_record(middle(), Vector{0.8, 0, 0} * scale(),
                                                         Vector{0, 0.8, 0} * scale(), {2, 0, reach()});
  const std::vector<Ray> rays(std::size_t(num_pes()),
                              {middle() + Vector{0.2, 0.2, 0.5} * scale(), Vector{0, 0, -1.0}});
  EXPECT_EQ(ask(rays, {triangle}).may_cross, 0);
  triangle.face = 3;
  EXPECT_EQ(ask(rays, {triangle}).may_cross, num_pes());
}

INSTANTIATE_TEST_SUITE_P(Places, PrefilterRayTest,
                         testing::Values(Place{1, 0}, Place{1e3, 0}, Place{3e-7, 0}, Place{1e-150, 0},
                                         Place{1e100, 0}, Place{1, 1e6}),
                         [](const auto& suite) { return "number" + std::to_string(suite.index); });

}  // namespace prefilter_ray_test
