#include "firmware/path_tracer/sampling/light_sampling.hpp"

#include <cmath>
#include <random>

#include "firmware/path_tracer/program/layout.hpp"
#include "tests/support/strip_fixture.hpp"

namespace light_sampling_test {

using cn::poly;
using cn::vec3;
using path_tracer::LightSampling;
using path_tracer::LightShape;
using test_support::load;
using test_support::PerPe;
using test_support::store;
using Vector = vec3<double>;

constexpr double kPi = path_tracer::kPi;

double length(const Vector& v) {
  return std::sqrt(dot(v, v));
}
Vector unit(const Vector& v) {
  return v * (1.0 / length(v));
}

/// A light and the point that it may light.
struct Setting {
  const char* name;
  LightShape shape;
  Vector vertex;
  Vector edge1;
  Vector edge2;
  Vector position;
  Vector normal;
};

std::vector<Vector> corners(const Setting& s) {
  const Vector a = s.vertex - s.position;
  if (s.shape == LightShape::triangle) return {a, a + s.edge1, a + s.edge2};
  return {a, a + s.edge1, a + s.edge1 + s.edge2, a + s.edge2};
}

/// The part of a polygon above the plane through the origin (Sutherland and Hodgman 1974).
std::vector<Vector> above(const std::vector<Vector>& polygon, const Vector& normal) {
  std::vector<Vector> part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector& p = polygon[i];
    const Vector& q = polygon[(i + 1) % polygon.size()];
    const double hp = dot(p, normal);
    const double hq = dot(q, normal);
    if (hp >= 0) part.push_back(p);
    if ((hp >= 0) != (hq >= 0)) part.push_back(p + (q - p) * (hp / (hp - hq)));
  }
  return part;
}

/// Integral of the cosine over the solid angle of a polygon: Lambert's sum over its edges.
double lambert(const Setting& s) {
  const std::vector<Vector> polygon = above(corners(s), s.normal);
  double sum = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vector a = unit(polygon[i]);
    const Vector b = unit(polygon[(i + 1) % polygon.size()]);
    const Vector axis = cross(a, b);
    const double sine = length(axis);
    if (sine > 0) sum += std::atan2(sine, dot(a, b)) * dot(axis, s.normal) / sine;
  }
  return 0.5 * std::abs(sum);
}

/// Of a triangle seen from the origin (Van Oosterom and Strackee 1983), in extended precision. The volume
/// comes from the edges: of unit vectors that differ in their last digits only, little would be left.
double solid_angle(const Vector& p, const Vector& q, const Vector& r) {
  using Long = vec3<long double>;
  const auto extended = [](const Vector& v) { return Long{v.x, v.y, v.z}; };
  const auto length_of = [](const Long& v) { return std::sqrt(dot(v, v)); };
  const Long a = extended(p);
  const Long b = extended(q);
  const Long c = extended(r);
  const long double la = length_of(a);
  const long double lb = length_of(b);
  const long double lc = length_of(c);
  const long double volume = std::abs(dot(a, cross(b - a, c - a))) / (la * lb * lc);
  return double(
      2 * std::atan2(volume, 1 + dot(a, b) / (la * lb) + dot(b, c) / (lb * lc) + dot(c, a) / (lc * la)));
}

double area(const Setting& s) {
  return length(cross(s.edge1, s.edge2)) * (s.shape == LightShape::triangle ? 0.5 : 1.0);
}

const std::vector<Setting>& settings() {
  constexpr auto kTriangle = LightShape::triangle;
  constexpr auto kRectangle = LightShape::rectangle;
  // Lights at height 2 face down: edge1 x edge2 = -y.
  const Vector x{1, 0, 0};
  const Vector z{0, 0, 1};
  static const std::vector<Setting> all = {
      {"triangle overhead", kTriangle, {-0.5, 2, -0.5}, x, z, {0, 0, 0}, {0, 1, 0}},
      {"triangle aside", kTriangle, {3, 2, 1}, x, z, {0, 0, 0}, {0, 1, 0}},
      {"triangle to a leaning surface", kTriangle, {1, 2, 1}, x * 2, z, {0, 0, 0}, unit({1, 0.5, -0.2})},
      {"triangle, half below the horizon", kTriangle, {-1, 2, -1}, x * 3, z * 3, {0, 0, 0}, {1, 0, 0}},
      {"triangle close by", kTriangle, {-5, 0.05, -5}, x * 20, z * 20, {0, 0, 0}, {0, 1, 0}},
      {"triangle, thin", kTriangle, {-1, 2, 0}, x * 4, z * 1e-3, {0, 0, 0}, unit({0.3, 1, 0})},
      {"needle across, short side opposite the first corner",
       kTriangle,
       {-7, 0.01, 0.003},
       x * 15,
       x * 15 + z * 2e-6,
       {0, 0, 0},
       {0, 1, 0}},
      {"needle across, short side at the first corner",
       kTriangle,
       {-7, 0.01, 0.003},
       x * 15,
       z * 2e-6,
       {0, 0, 0},
       {0, 1, 0}},
      {"needle across, short side is the second edge",
       kTriangle,
       {-7, 0.01, 0.003},
       z * -2e-6,
       x * 15,
       {0, 0, 0},
       unit({0.3, 1, 0})},
      {"needle across, aspect 1e12", kTriangle, {-3, 1e-3, 1e-5}, x * 7, z * 1e-11, {0, 0, 0}, {0, 1, 0}},
      {"needle away from the point", kTriangle, {0.5, 0.1, 0}, x * 15, z * 1e-4, {0, 0, 0}, unit({1, 1, 0})},
      {"needle with its point overhead",
       kTriangle,
       {0, 0.2, 0},
       x * 3,
       z * 1e-6 + x * 3,
       {0, 0, 0},
       {0, 1, 0}},
      {"triangle, nearly a half-space", kTriangle, {-30, 1, -30}, x * 90, z * 90, {0, 0, 0}, {0, 1, 0}},
      {"triangle, nearly edge on", kTriangle, {3, 2e-3, 0}, x, z, {0, 0, 0}, unit({1, 1, 0})},
      {"triangle, far", kTriangle, {1000, 2000, 500}, x, z, {0, 0, 0}, {0, 1, 0}},
      {"triangle, a large one far away", kTriangle, {1e5, 2e5, 5e4}, x * 1e3, z * 1e3, {0, 0, 0}, {0, 1, 0}},
      {"rectangle overhead", kRectangle, {-0.5, 2, -0.5}, x, z, {0, 0, 0}, {0, 1, 0}},
      {"rectangle aside", kRectangle, {3, 2, 1}, x, z * 2, {0, 0, 0}, {0, 1, 0}},
      {"rectangle below its edge", kRectangle, {0, 2, 0}, x, z, {0, 0, 0}, {0, 1, 0}},
      {"rectangle to a wall", kRectangle, {213, 548.8, 227}, x * 130, z * 105, {0, 200, 300}, {1, 0, 0}},
      {"rectangle, half below the horizon", kRectangle, {-1, 2, -1}, x * 2, z * 2, {0, 0, 0}, {1, 0, 0}},
      {"rectangle close by", kRectangle, {-5, 0.05, -4}, x * 11, z * 9, {0, 0, 0}, {0, 1, 0}},
      {"rectangle close by, to a wall",
       kRectangle,
       {-5, 0.05, -4},
       x * 11,
       z * 9,
       {0, 0, 0},
       unit({1, 0.1, 0})},
      {"rectangle, thin", kRectangle, {-1, 2, 0}, x * 4, z * 1e-3, {0, 0, 0}, unit({0.3, 1, 0})},
      {"rectangle, nearly edge on", kRectangle, {3, 2e-3, 0}, x, z, {0, 0, 0}, unit({1, 1, 0})},
      {"rectangle, far", kRectangle, {1000, 2000, 500}, x, z, {0, 0, 0}, {0, 1, 0}},
  };
  return all;
}

struct Sampled {
  vec3<PerPe<double>> to_light;
  PerPe<double> weight;
};

class LightSamplingTest : public test_support::StripFixture {
 protected:
  LightSamplingTest() : StripFixture(1024) {}

  PerPe<double> uniform() {
    PerPe<double> values = per_pe<double>();
    for (double& value : values) value = (static_cast<double>(random() >> 32) + 0.5) * 0x1p-32;
    return values;
  }

  Sampled sample(const Setting& s, LightSampling sampling, const PerPe<double>& u, const PerPe<double>& v) {
    Sampled result{{per_pe<double>(), per_pe<double>(), per_pe<double>()}, per_pe<double>()};
    const path_tracer::LightSurface light{{s.vertex.x, s.vertex.y, s.vertex.z},
                                          {s.edge1.x, s.edge1.y, s.edge1.z},
                                          {s.edge2.x, s.edge2.y, s.edge2.z},
                                          {0.0, -1.0, 0.0}};
    run([&] {
      const path_tracer::Point3 position{s.position.x, s.position.y, s.position.z};
      const path_tracer::Direction3 normal{s.normal.x, s.normal.y, s.normal.z};
      const path_tracer::LightSample found =
          sampling == LightSampling::area
              ? path_tracer::sample_light_area(light, position, normal, load(u), load(v))
              : path_tracer::sample_light_solid_angle(light, static_cast<std::int32_t>(s.shape), position,
                                                      normal, load(u), load(v));
      store(result.to_light.x, found.to_light.x);
      store(result.to_light.y, found.to_light.y);
      store(result.to_light.z, found.to_light.z);
      store(result.weight, found.weight);
    });
    return result;
  }

  /// Sums over many points of f(to_light, weight), which counts where the weight is positive.
  struct Mean {
    double mean = 0;
    double deviation = 0;  ///< of the mean
  };
  template <class Value>
  Mean mean_of(const Setting& s, LightSampling sampling, Value value) {
    double sum = 0;
    double squares = 0;
    constexpr int kRounds = 128;
    for (int round = 0; round < kRounds; ++round) {
      const Sampled samples = sample(s, sampling, uniform(), uniform());
      for (std::size_t i = 0; i < samples.weight.size(); ++i) {
        const double found = value(
            Vector{samples.to_light.x[i], samples.to_light.y[i], samples.to_light.z[i]}, samples.weight[i]);
        sum += found;
        squares += found * found;
      }
    }
    const double count = double(kRounds) * num_pes();
    const double mean = sum / count;
    return {mean, std::sqrt(std::max(0.0, squares / count - mean * mean) / count)};
  }

  std::mt19937_64 random{33};
};

double positive(double weight) {
  return std::max(weight, 0.0);
}

TEST_F(LightSamplingTest, IrradianceIsLambertsFormFactor) {
  for (const Setting& s : settings()) {
    const double expected = lambert(s);
    ASSERT_GT(expected, 0.0) << s.name;
    const Mean found = mean_of(s, LightSampling::solid_angle,
                               [&](const Vector&, double weight) { return positive(weight) * area(s); });
    EXPECT_NEAR(found.mean, expected, 4.5 * found.deviation + 1e-9 * expected) << s.name;
    // The spread that remains after the warp; with a plain solid angle it would be the spread of the cosine.
    EXPECT_LT(found.deviation, 2.5e-3 * expected) << s.name;
  }
}

TEST_F(LightSamplingTest, AgreesWithAreaSampling) {
  for (const Setting& s : settings()) {
    if (s.shape == LightShape::rectangle) continue;  // area sampling knows triangles only
    const auto irradiance = [&](const Vector&, double weight) { return positive(weight) * area(s); };
    const Mean by_area = mean_of(s, LightSampling::area, irradiance);
    const Mean by_angle = mean_of(s, LightSampling::solid_angle, irradiance);
    EXPECT_NEAR(by_area.mean, by_angle.mean, 4.5 * std::hypot(by_area.deviation, by_angle.deviation))
        << s.name;
    EXPECT_LE(by_angle.deviation, by_area.deviation * 1.001) << s.name;
  }
}

/// 1 / density, averaged over the samples, is the solid angle: the density integrates to 1 over it.
TEST_F(LightSamplingTest, TheDensityIntegratesToOne) {
  for (const Setting& s : settings()) {
    const std::vector<Vector> polygon = corners(s);
    double expected = 0;
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
      expected += solid_angle(polygon[0], polygon[i], polygon[i + 1]);
    double least = 1;
    for (const Vector& corner : polygon) least = std::min(least, dot(unit(corner), s.normal));
    if (least <= 0) continue;  // weights are 0 below the horizon: no density can be read off them
    const Mean found = mean_of(s, LightSampling::solid_angle, [&](const Vector& to_light, double weight) {
      return weight * area(s) / dot(unit(to_light), s.normal);
    });
    EXPECT_NEAR(found.mean, expected, 4.5 * found.deviation + 1e-8 * expected) << s.name;
  }
}

/// Means over the light of an odd function about its middle would reveal samples at the wrong places.
TEST_F(LightSamplingTest, WeightsBelongToTheirDirections) {
  for (const Setting& s : settings()) {
    if (s.shape == LightShape::rectangle) continue;
    for (const Vector& along : {s.edge1, s.edge2}) {
      const auto moment = [&](const Vector& to_light, double weight) {
        return positive(weight) * area(s) *
               (dot(to_light - (s.vertex - s.position), along) / dot(along, along) - 1.0 / 3.0);
      };
      const Mean by_area = mean_of(s, LightSampling::area, moment);
      const Mean by_angle = mean_of(s, LightSampling::solid_angle, moment);
      EXPECT_NEAR(by_area.mean, by_angle.mean, 4.5 * std::hypot(by_area.deviation, by_angle.deviation))
          << s.name;
    }
  }
}

TEST_F(LightSamplingTest, PointsLieOnTheLight) {
  PerPe<double> u = uniform();
  PerPe<double> v = uniform();
  const double ends[] = {0x1p-33, 0.25, 0.5, 1.0 - 0x1p-33, 0.0};
  for (std::size_t i = 0; i < 25; ++i) u[i] = ends[i % 5], v[i] = ends[i / 5];
  for (const Setting& s : settings()) {
    const Sampled samples = sample(s, LightSampling::solid_angle, u, v);
    const double size = length(s.edge1) + length(s.edge2);
    for (std::size_t i = 0; i < u.size(); ++i) {
      const Vector at = Vector{samples.to_light.x[i], samples.to_light.y[i], samples.to_light.z[i]} -
                        (s.vertex - s.position);
      // Cramer's rule in the lights' plane.
      const double determinant = s.edge1.x * s.edge2.z - s.edge1.z * s.edge2.x;
      const double a = (at.x * s.edge2.z - at.z * s.edge2.x) / determinant;
      const double b = (s.edge1.x * at.z - s.edge1.z * at.x) / determinant;
      ASSERT_TRUE(std::isfinite(samples.weight[i])) << s.name << " " << u[i] << " " << v[i];
      EXPECT_NEAR(at.y, 0.0, 1e-9 * size) << s.name;
      EXPECT_GE(a, -1e-6) << s.name << " " << u[i] << " " << v[i];
      EXPECT_GE(b, -1e-6) << s.name << " " << u[i] << " " << v[i];
      if (s.shape == LightShape::triangle)
        EXPECT_LE(a + b, 1 + 1e-6) << s.name << " " << u[i] << " " << v[i];
      else
        EXPECT_LE(std::max(a, b), 1 + 1e-6) << s.name << " " << u[i] << " " << v[i];
    }
  }
}

TEST_F(LightSamplingTest, NothingComesFromBehind) {
  for (Setting s : settings()) {
    s.position = s.position + Vector{0, 5e6, 0};
    const Sampled behind = sample(s, LightSampling::solid_angle, uniform(), uniform());
    for (std::size_t i = 0; i < behind.weight.size(); ++i) {
      EXPECT_LE(behind.weight[i], 0.0) << s.name;
      EXPECT_TRUE(std::isfinite(behind.to_light.x[i] + behind.to_light.y[i] + behind.to_light.z[i]))
          << s.name;
    }
    s.position.y = s.vertex.y;  // in the light's plane
    for (const double weight : sample(s, LightSampling::solid_angle, uniform(), uniform()).weight)
      EXPECT_LE(weight, 0.0) << s.name;
  }
}

TEST_F(LightSamplingTest, ASurfaceTurnedAwayGetsNothing) {
  for (Setting s : settings()) {
    s.normal = {0, -1, 0};
    for (const double weight : sample(s, LightSampling::solid_angle, uniform(), uniform()).weight)
      EXPECT_LE(weight, 0.0) << s.name;
  }
}

TEST_F(LightSamplingTest, LinearDensitiesAreSampled) {
  for (const auto& [at_0, at_1] : {std::pair(1.0, 1.0), {0.01, 1.0}, {1.0, 0.01}, {2.0, 3.0}}) {
    const PerPe<double> u = uniform();
    PerPe<double> x = per_pe<double>();
    run([&, first = at_0, last = at_1] { store(x, path_tracer::sample_linear(load(u), first, last)); });
    for (std::size_t i = 0; i < u.size(); ++i) {
      const double cdf = (at_0 * x[i] + 0.5 * (at_1 - at_0) * x[i] * x[i]) / (0.5 * (at_0 + at_1));
      EXPECT_NEAR(cdf, u[i], 1e-14);
    }
  }
}

}  // namespace light_sampling_test
