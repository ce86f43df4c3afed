#include "firmware/path_tracer/sampling/sampling.hpp"

#include "firmware/path_tracer/kernels/camera_rays.hpp"
#include "firmware/path_tracer/sampling/random.hpp"

#include <random>

#include "tests/support/chi_square.hpp"
#include "tests/support/strip_fixture.hpp"

namespace sampling_test {

using cn::poly;
using cn::vec3;
using path_tracer::CameraRecord;
using path_tracer::Direction3;
using test_support::ChiSquare;
using test_support::load;
using test_support::PerPe;
using test_support::store;

using Vectors = vec3<PerPe<double>>;

constexpr double kSmallest = 0x1p-33;  // what uniform4 gives, at both ends
constexpr double kLargest = 1.0 - 0x1p-33;

double length(const vec3<double>& v) {
  return std::sqrt(dot(v, v));
}
vec3<double> unit(const vec3<double>& v) {
  return v * (1.0 / length(v));
}

class Sampling : public test_support::StripFixture {
 protected:
  Sampling() : StripFixture(1024) {}

  PerPe<double> uniform() {
    PerPe<double> values = per_pe<double>();
    for (double& value : values) value = (static_cast<double>(random() >> 32) + 0.5) * 0x1p-32;
    return values;
  }
  static vec3<double> at(const Vectors& v, std::size_t pe) { return {v.x[pe], v.y[pe], v.z[pe]}; }

  /// Returns what `function` returns in each PE.
  template <class Function>
  Vectors vectors(Function function) {
    Vectors result{per_pe<double>(), per_pe<double>(), per_pe<double>()};
    run([&] {
      const vec3<poly<double>> v = function();
      store(result.x, v.x);
      store(result.y, v.y);
      store(result.z, v.z);
    });
    return result;
  }

  Vectors sample_cosine(const vec3<double>& normal, const PerPe<double>& u, const PerPe<double>& v) {
    return vectors([&] {
      return path_tracer::sample_cosine({normal.x, normal.y, normal.z}, load(u), load(v));
    });
  }

  std::mt19937_64 random{21};
};

const vec3<double> kNormals[] = {
    {1, 0, 0},  {-1, 0, 0},      {0, 1, 0},           {0, -1, 0},          {0, 0, 1},
    {0, 0, -1}, unit({1, 2, 3}), unit({-3, 0.5, -1}), unit({1e-9, 0, -1}), unit({-0.5, -0.7, 0.2})};

/// Density cos / pi over the hemisphere: the square of the cosine and the angle around the normal are
/// uniform.
TEST_F(Sampling, CosineDensityAroundAnyNormal) {
  for (const vec3<double>& normal : kNormals) {
    SCOPED_TRACE(testing::Message() << normal.x << " " << normal.y << " " << normal.z);
    const vec3<double> aside = std::abs(normal.x) < 0.5 ? vec3<double>{1, 0, 0} : vec3<double>{0, 1, 0};
    const vec3<double> tangent = unit(cross(aside, normal));
    const vec3<double> bitangent = cross(normal, tangent);
    ChiSquare bins = ChiSquare::uniform(16 * 16);
    for (int round = 0; round < 100; ++round) {
      const Vectors directions = sample_cosine(normal, uniform(), uniform());
      for (std::size_t pe = 0; pe < directions.x.size(); ++pe) {
        const vec3<double> d = at(directions, pe);
        const double cosine = dot(d, normal);
        const double turn = std::atan2(dot(d, bitangent), dot(d, tangent)) / (2 * path_tracer::kPi) + 0.5;
        ASSERT_GT(cosine, 0.0);
        ASSERT_NEAR(length(d), 1.0, 4e-16);
        bins.add(std::min<std::size_t>(15, static_cast<std::size_t>(cosine * cosine * 16)) * 16 +
                 std::min<std::size_t>(15, static_cast<std::size_t>(turn * 16)));
      }
    }
    EXPECT_LT(std::abs(bins.deviation()), 4.0);
  }
}

/// One of these points of the sphere is 1e-9 from the opposite of each axis. Adding the normal leaves a
/// vector of that length with an error of 1e-16. So the direction may lie in the surface, or up to 1e-7 below
/// a tilted one.
TEST_F(Sampling, CosineDirectionsAreFineAtTheEndsOfTheRange) {
  PerPe<double> u = uniform();
  PerPe<double> v = uniform();
  const double ends[] = {kSmallest,       0.25 - kSmallest, 0.25 + kSmallest, 0.5 - kSmallest,
                         0.5 + kSmallest, 0.75 + kSmallest, kLargest};
  for (std::size_t i = 0; i < 49; ++i) u[i] = ends[i % 7], v[i] = ends[i / 7];
  for (const vec3<double>& normal : kNormals) {
    const Vectors directions = sample_cosine(normal, u, v);
    for (std::size_t i = 0; i < 49; ++i) {
      EXPECT_NEAR(length(at(directions, i)), 1.0, 4e-16) << u[i] << " " << v[i];
      EXPECT_GE(dot(at(directions, i), normal), -1e-7) << u[i] << " " << v[i];
    }
  }
}

TEST_F(Sampling, VectorsWithoutLengthBecomeTheFallback) {
  const auto normalize = [&](const vec3<double>& v) {
    const Direction3 fallback{0.0, 0.6, 0.8};
    return at(vectors([&] { return path_tracer::normalize({v.x, v.y, v.z}, fallback); }), 0);
  };
  for (const double tiny : {0.0, 1e-200, 1e-16, std::numeric_limits<double>::quiet_NaN()}) {
    const vec3<double> found = normalize({tiny, -tiny, 0});
    EXPECT_EQ(found.x, 0.0);
    EXPECT_EQ(found.y, 0.6);
    EXPECT_EQ(found.z, 0.8);
  }
  for (const double size : {1e-14, 1.0, 1e100}) {
    const vec3<double> found = normalize({3 * size, 0, -4 * size});
    EXPECT_NEAR(found.x, 0.6, 2e-16);
    EXPECT_EQ(found.y, 0.0);
    EXPECT_NEAR(found.z, -0.8, 2e-16);
  }
}

TEST_F(Sampling, TrianglePointsAreUniformAndInside) {
  // Cells of a triangular grid with 8 rows have equal areas; the edges make barycentric coordinates readable.
  const vec3<poly<double>> vertex{2.0, -1.0, 4.0};
  const vec3<poly<double>> edge1{4.0, 0.0, 0.0};
  const vec3<poly<double>> edge2{0.0, 0.5, 2.0};
  ChiSquare bins = ChiSquare::uniform(64);
  for (int round = 0; round < 100; ++round) {
    const PerPe<double> u = uniform();
    const PerPe<double> v = uniform();
    const Vectors points =
        vectors([&] { return path_tracer::sample_triangle(vertex, edge1, edge2, load(u), load(v)); });
    for (std::size_t pe = 0; pe < points.x.size(); ++pe) {
      const double a = (points.x[pe] - 2.0) / 4.0;
      const double b = (points.z[pe] - 4.0) / 2.0;
      ASSERT_NEAR(points.y[pe], -1.0 + 0.5 * b, 1e-15);
      ASSERT_TRUE(a > 0 && b > 0 && a + b < 1 + 1e-15) << a << " " << b;
      const int row = static_cast<int>(b * 8);
      const int column = static_cast<int>(a * 8);
      const bool upper = a * 8 - column + (b * 8 - row) > 1;
      const int cells_below = row * (16 - row);  // rows of 15, 13, 11, ... cells
      bins.add(static_cast<std::size_t>(cells_below + 2 * column + (upper ? 1 : 0)));
    }
  }
  EXPECT_LT(std::abs(bins.deviation()), 4.0);
}

TEST_F(Sampling, CdfEntriesAreChosenByTheirProbability) {
  const std::vector<double> probabilities{0.1, 0.35, 0.05, 0.5};
  const double cdf[] = {0.1, 0.45, 0.5, 1.0};
  ChiSquare bins(probabilities);
  PerPe<std::int32_t> chosen = per_pe<std::int32_t>();
  for (int round = 0; round < 100; ++round) {
    const PerPe<double> u = uniform();
    run([&] { store(chosen, path_tracer::sample_cdf(cdf, 4, load(u))); });
    for (const std::int32_t entry : chosen) bins.add(static_cast<std::size_t>(entry));
  }
  EXPECT_LT(std::abs(bins.deviation()), 4.0);
}

TEST_F(Sampling, CdfEntriesEndWhereTheTableSays) {
  const double cdf[] = {0.25, 0.25, 0.5, 1.0 - 1e-12};  // the second never; the last in spite of rounding
  const std::vector<std::pair<double, int>> expected{
      {kSmallest, 0}, {0.25 - kSmallest, 0}, {0.25, 2},       {0.5 - kSmallest, 2},
      {0.5, 3},       {kLargest, 3},         {1.0 - 1e-13, 3}};
  PerPe<double> u = per_pe<double>();
  for (std::size_t i = 0; i < expected.size(); ++i) u[i] = expected[i].first;
  PerPe<std::int32_t> chosen = per_pe<std::int32_t>(-1);
  run([&] { store(chosen, path_tracer::sample_cdf(cdf, 4, load(u))); });
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(chosen[i], expected[i].second) << u[i];
  run([&] { store(chosen, path_tracer::sample_cdf(cdf, 1, load(u))); });
  for (const std::int32_t entry : chosen) EXPECT_EQ(entry, 0);
}

TEST_F(Sampling, WhatACdfEntryLeavesIsUniformAgain) {
  const double cdf[] = {0.1, 0.45, 0.5, 1.0 - 1e-12};
  const double low[] = {0.0, 0.1, 0.45, 0.5};
  PerPe<std::int32_t> entry = per_pe<std::int32_t>();
  PerPe<double> rest = per_pe<double>();
  for (int round = 0; round < 4; ++round) {
    PerPe<double> u = uniform();
    u[0] = kLargest;
    run([&] {
      const auto chosen = path_tracer::sample_cdf_stretched(cdf, 4, load(u));
      store(entry, chosen.entry);
      store(rest, chosen.rest);
    });
    for (std::size_t pe = 0; pe < u.size(); ++pe) {
      const auto i = static_cast<std::size_t>(entry[pe]);
      ASSERT_GE(rest[pe], 0.0);
      ASSERT_LT(rest[pe], 1.0);
      EXPECT_NEAR(low[i] + rest[pe] * (cdf[i] - low[i]), u[pe], 1e-11);
    }
  }
  const PerPe<double> u = uniform();
  run([&] { store(rest, path_tracer::sample_cdf_stretched(cdf, 1, load(u)).rest); });
  EXPECT_EQ(rest, u);
}

/// u falls into a class by the cdf, then into one of its lights, which have equal parts of the class; what is
/// left of u is its position in that part.
TEST_F(Sampling, LightClassesAreCutIntoEqualParts) {
  const double cdf[] = {0.5, 0.6, 1.0};
  const path_tracer::LightClass classes[] = {{0, 2}, {2, 1}, {3, 1000}};
  PerPe<std::int32_t> entry = per_pe<std::int32_t>();
  PerPe<double> rest = per_pe<double>();
  for (int round = 0; round < 40; ++round) {
    PerPe<double> u = uniform();
    u[0] = kSmallest;
    u[1] = kLargest;
    u[2] = 0.5;
    u[3] = 0.25;
    run([&] {
      const auto chosen = path_tracer::sample_light_class(cdf, classes, 3, load(u));
      store(entry, chosen.entry);
      store(rest, chosen.rest);
    });
    for (std::size_t pe = 0; pe < u.size(); ++pe) {
      const int number = u[pe] < cdf[0] ? 0 : u[pe] < cdf[1] ? 1 : 2;
      const path_tracer::LightClass& of = classes[number];
      const double low = number == 0 ? 0.0 : cdf[number - 1];
      const double part = (cdf[number] - low) / of.count;
      const int in_class = entry[pe] - of.first;
      ASSERT_GE(in_class, 0);
      ASSERT_LT(in_class, of.count);
      ASSERT_GE(rest[pe], 0.0);
      ASSERT_LT(rest[pe], 1.0);
      EXPECT_NEAR(low + (in_class + rest[pe]) * part, u[pe], 1e-12);
    }
  }
}

class CameraSampling : public Sampling {
 protected:
  /// A camera whose film coordinates can be read off its directions: (x, y, 1) to unit length.
  static CameraRecord readable_camera(int width, int height) {
    CameraRecord camera;
    camera.position = {5, 6, 7};
    camera.direction = {0, 0, 1};
    camera.right = {1, 0, 0};
    camera.down = {0, 1, 0};
    camera.width = width;
    camera.height = height;
    return camera;
  }

  /// Film coordinates of one sample of each pixel; pixel numbers of unused PEs are -1.
  struct Samples {
    Vectors direction;
    Vectors origin;
    PerPe<double> random_x;
    PerPe<double> random_y;
  };
  Samples sample(const CameraRecord& camera, const PerPe<std::int32_t>& pixel, std::int32_t sample_number,
                 int pes) {
    Samples s{{per_pe<double>(), per_pe<double>(), per_pe<double>()}, {}, per_pe<double>(), per_pe<double>()};
    s.origin = s.direction;
    run(cn::LaneMask::first(pes), [&] {
      const auto drawn =
          path_tracer::uniform4(77, load(pixel), sample_number, 0, path_tracer::Purpose::camera);
      const auto ray = path_tracer::sample_camera(camera, load(pixel), drawn.value[0], drawn.value[1]);
      store(s.direction.x, ray.direction.x);
      store(s.direction.y, ray.direction.y);
      store(s.direction.z, ray.direction.z);
      store(s.origin.x, ray.origin.x);
      store(s.origin.y, ray.origin.y);
      store(s.origin.z, ray.origin.z);
      store(s.random_x, drawn.value[0]);
      store(s.random_y, drawn.value[1]);
    });
    return s;
  }

  void expect_in_box(const CameraRecord& camera, const Samples& s, const PerPe<std::int32_t>& pixel,
                     int pes) {
    for (std::size_t pe = 0; pe < std::size_t(pes); ++pe) {
      const double x = s.direction.x[pe] / s.direction.z[pe];
      const double y = s.direction.y[pe] / s.direction.z[pe];
      const int column = pixel[pe] % camera.width;
      const int row = pixel[pe] / camera.width;
      ASSERT_EQ(std::floor(x), column) << "width " << camera.width << " pixel " << pixel[pe];
      ASSERT_EQ(std::floor(y), row) << "width " << camera.width << " pixel " << pixel[pe];
      ASSERT_NEAR(x, column + s.random_x[pe], 2e-11);
      ASSERT_NEAR(y, row + s.random_y[pe], 2e-11);
    }
  }
};

TEST_F(CameraSampling, EverySampleLiesInItsPixel) {
  const CameraRecord camera = readable_camera(32, 32);
  PerPe<std::int32_t> pixel = per_pe<std::int32_t>();
  for (int pe = 0; pe < num_pes(); ++pe) pixel[std::size_t(pe)] = pe;
  ChiSquare within = ChiSquare::uniform(16 * 16);
  for (int number = 0; number < 64; ++number) {
    const Samples s = sample(camera, pixel, number, num_pes());
    expect_in_box(camera, s, pixel, num_pes());
    for (std::size_t pe = 0; pe < pixel.size(); ++pe) {
      EXPECT_NEAR(length(at(s.direction, pe)), 1.0, 4e-16);
      EXPECT_EQ(s.origin.x[pe], 5.0);
      EXPECT_EQ(s.origin.y[pe], 6.0);
      EXPECT_EQ(s.origin.z[pe], 7.0);
      const double x = s.direction.x[pe] / s.direction.z[pe] - pixel[pe] % 32;
      const double y = s.direction.y[pe] / s.direction.z[pe] - pixel[pe] / 32;
      within.add(static_cast<std::size_t>(y * 16) * 16 + static_cast<std::size_t>(x * 16));
    }
  }
  EXPECT_LT(std::abs(within.deviation()), 4.0);
}

TEST_F(CameraSampling, EveryRowStartsAndEndsAtItsPixels) {
  for (const int width : {1, 2, 3, 7, 480, 4095, 10923, 16383, 16384}) {
    const CameraRecord camera = readable_camera(width, 16384);
    for (int first_row = 0; first_row < 16384; first_row += num_pes() / 2) {
      PerPe<std::int32_t> pixel = per_pe<std::int32_t>();
      for (int pe = 0; pe < num_pes(); ++pe)
        pixel[std::size_t(pe)] = (first_row + pe / 2) * width + (pe % 2 == 0 ? 0 : width - 1);
      expect_in_box(camera, sample(camera, pixel, 3, num_pes()), pixel, num_pes());
    }
  }
}

TEST_F(CameraSampling, TheLastRowsOfEveryWidth) {
  for (int width = 1; width <= 16384; ++width) {
    const CameraRecord camera = readable_camera(width, 16384);
    PerPe<std::int32_t> pixel = per_pe<std::int32_t>();
    for (int i = 0; i < 8; ++i) pixel[std::size_t(i)] = (16384 - i / 2) * width - (i % 2 == 0 ? 1 : width);
    expect_in_box(camera, sample(camera, pixel, 0, 8), pixel, 8);
  }
}

TEST_F(CameraSampling, DirectionsGoThroughTheFilm) {
  CameraRecord camera;
  camera.direction = {-3, 2, 4};
  camera.right = {0.5, 0.25, 0};
  camera.down = {0, -0.5, 0.125};
  camera.width = 40;
  camera.height = 30;
  const Samples s = sample(camera, per_pe<std::int32_t>(40 * 11 + 23), 5, num_pes());
  const double x = 23 + s.random_x[0];
  const double y = 11 + s.random_y[0];
  const vec3<double> expected = unit({-3 + 0.5 * x, 2 + 0.25 * x - 0.5 * y, 4 + 0.125 * y});
  EXPECT_NEAR(s.direction.x[0], expected.x, 4e-16);
  EXPECT_NEAR(s.direction.y[0], expected.y, 4e-16);
  EXPECT_NEAR(s.direction.z[0], expected.z, 4e-16);
}

/// All numbers have few digits, so the sums are exact.
TEST_F(CameraSampling, OrthographicRaysStartOnTheFilmAndAreParallel) {
  CameraRecord camera;
  camera.position = {-3, 2, 4};
  camera.direction = {0, 0.6, -0.8};
  camera.right = {0.5, 0.25, 0};
  camera.down = {0, -0.5, 0.125};
  camera.width = 40;
  camera.height = 30;
  camera.is_orthographic = 1;
  Vectors origin{per_pe<double>(), per_pe<double>(), per_pe<double>()};
  Vectors direction = origin;
  run([&] {
    const auto ray = path_tracer::sample_camera(camera, 40 * 11 + 23, 0.25, 0.5);
    store(origin.x, ray.origin.x);
    store(origin.y, ray.origin.y);
    store(origin.z, ray.origin.z);
    store(direction.x, ray.direction.x);
    store(direction.y, ray.direction.y);
    store(direction.z, ray.direction.z);
  });
  EXPECT_EQ(origin.x[0], -3 + 0.5 * 23.25);
  EXPECT_EQ(origin.y[0], 2 + 0.25 * 23.25 - 0.5 * 11.5);
  EXPECT_EQ(origin.z[0], 4 + 0.125 * 11.5);
  EXPECT_EQ(direction.x[0], 0.0);
  EXPECT_EQ(direction.y[0], 0.6);
  EXPECT_EQ(direction.z[0], -0.8);
}

}  // namespace sampling_test
