// Compares a plane under a parallel square light with its closed form. The light reflects nothing and the
// scene is otherwise empty, so the plane's radiance is (reflectance / pi) * irradiance.

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/statistics.hpp"

namespace direct_light_test {

using path_tracer::Program;
using test_support::FilmSize;
using test_support::PlaneAndLight;
using test_support::render_options;
using testbench::Camera;
using testbench::Film;
using testbench::render_natively;
using testbench::RenderResult;
using testbench::Scene;

constexpr double kPi = 3.14159265358979323846;
const PlaneAndLight kValues{{0.25, 0.5, 0.75}, {4.0, 2.0, 1.0}};

/// The form factor of a parallel rectangle a x b at height h with a corner above the plane element: its share
/// of the element's cosine-weighted hemisphere (Howell's catalogue of configuration factors, B-3).
double corner_form_factor(double a, double b, double h) {
  const double x = a / h;
  const double y = b / h;
  const double rx = std::sqrt(1 + x * x);
  const double ry = std::sqrt(1 + y * y);
  return (x / rx * std::atan(y / rx) + y / ry * std::atan(x / ry)) / (2 * kPi);
}

/// The form factor of the whole light, seen from (x, 0, z). corner_form_factor() is odd in a and b, so the
/// four corners are added with their signs.
double light_form_factor(double x, double z) {
  constexpr double kSide = PlaneAndLight::kLightHalfSide;
  constexpr double kHeight = PlaneAndLight::kLightHeight;
  return corner_form_factor(kSide - x, kSide - z, kHeight) +
         corner_form_factor(kSide + x, kSide - z, kHeight) +
         corner_form_factor(kSide - x, kSide + z, kHeight) +
         corner_form_factor(kSide + x, kSide + z, kHeight);
}

/// The same number computed in another way: Lambert's sum over the edges of a polygon, seen from (x, 0, z)
/// with the normal up.
double polygon_form_factor(double x, double z) {
  constexpr double kSide = PlaneAndLight::kLightHalfSide;
  const glm::dvec3 from(x, 0, z);
  const double corners[4][2] = {{-1, -1}, {-1, 1}, {1, 1}, {1, -1}};
  double sum = 0;
  for (int i = 0; i < 4; ++i) {
    const auto direction = [&](int k) {
      const double* const corner = corners[k % 4];
      return glm::normalize(glm::dvec3(corner[0] * kSide, PlaneAndLight::kLightHeight, corner[1] * kSide) -
                            from);
    };
    const glm::dvec3 a = direction(i);
    const glm::dvec3 b = direction(i + 1);
    sum += std::acos(glm::dot(a, b)) * glm::normalize(glm::cross(a, b)).y;
  }
  return std::abs(sum) / (2 * kPi);
}

/// The point where the ray through a film position meets the plane y = 0.
glm::dvec3 plane_point(const Scene& scene, double column, double row) {
  const Camera& camera = scene.camera;
  const double pixel = 2 * std::tan(camera.vertical_field_of_view_radians / 2) / scene.film.height;
  const glm::dvec3 right = glm::cross(camera.direction, camera.up);
  const glm::dvec3 direction = camera.direction + right * ((column - 0.5 * scene.film.width) * pixel) -
                               camera.up * ((row - 0.5 * scene.film.height) * pixel);
  return camera.position - direction * (camera.position.y / direction.y);
}

/// The mean of the form factor over a pixel, by Gauss-Legendre quadrature with 4 x 4 points.
double pixel_form_factor(const Scene& scene, int pixel) {
  const double points[4] = {0.069431844202973712, 0.330009478207571868, 0.669990521792428132,
                            0.930568155797026288};
  const double weights[4] = {0.173927422568726929, 0.326072577431273071, 0.326072577431273071,
                             0.173927422568726929};
  double mean = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) {
      const glm::dvec3 at =
          plane_point(scene, pixel % scene.film.width + points[i], pixel / scene.film.width + points[j]);
      mean += weights[i] * weights[j] * light_form_factor(at.x, at.z);
    }
  }
  return mean;
}

TEST(DirectLight, ClosedFormsAgree) {
  for (const double x : {-3.0, -1.0, 0.0, 0.4, 1.7})
    for (const double z : {-2.0, 0.0, 0.9, 5.0})
      EXPECT_NEAR(light_form_factor(x, z), polygon_form_factor(x, z), 1e-14) << x << ", " << z;
  // Known value of a centred square of half side 1 at height 1.
  EXPECT_NEAR(4 * corner_form_factor(1, 1, 1), 0.5541, 5e-5);
}

void expect_closed_form(Program program) {
  const Scene scene = test_support::plane_under_light(kValues, {24, 16});
  constexpr int kSamples = 4096;
  const RenderResult result = render_natively(scene, render_options(program, kSamples));
  const Film& film = result.film;
  const double pixels = film.pixel_count();
  // Contributions of the light's points differ by a small factor, so sums of 4096 are nearly normal.
  const double threshold = test_support::normal_threshold(test_support::per_test(pixels + 1));
  double deviations = 0;
  double variances = 0;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    const glm::dvec3 expected = kValues.reflectance * kValues.radiance * pixel_form_factor(scene, pixel);
    const glm::dvec3 mean = film.mean(pixel);
    const glm::dvec3 variance = film.variance_of_mean(pixel);
    ASSERT_GT(variance.x, 0.0);
    EXPECT_LT(std::sqrt(variance.x), 0.03 * expected.x) << "too noisy to tell";
    const double z = (mean.x - expected.x) / std::sqrt(variance.x);
    EXPECT_LT(std::abs(z), threshold)
        << "pixel " << pixel << " is " << mean.x << ", expected is " << expected.x;
    EXPECT_NEAR(mean.y / expected.y, mean.x / expected.x, 1e-12);
    EXPECT_NEAR(mean.z / expected.z, mean.x / expected.x, 1e-12);
    deviations += mean.x - expected.x;
    variances += variance.x;
  }
  EXPECT_LT(std::abs(deviations) / std::sqrt(variances), threshold) << "mean of the film";
}

TEST(DirectLight, EveryPixelOfThePlaneIsTheClosedForm) {
  expect_closed_form(Program::full);
}

TEST(DirectLight, TheProgramWithoutTimedRadianceMakesTheSameImage) {
  const Scene scene = test_support::plane_under_light(kValues, {24, 16});
  EXPECT_EQ(render_natively(scene, render_options(Program::full, 16)).film.sha256(),
            render_natively(scene, render_options(Program::direct, 16)).film.sha256());
}

/// A path continues with the largest reflectance as its probability, and then hits the light with the form
/// factor as its probability.
TEST(DirectLight, FindingTheLightByHittingItAgrees) {
  const Scene scene = test_support::plane_under_light(kValues, {24, 16});
  constexpr int kSamples = 4096;
  const double survival = kValues.reflectance.z;
  const glm::dvec3 of_hit = kValues.reflectance / survival * kValues.radiance;
  const Film film = render_natively(scene, render_options(Program::segments, kSamples)).film;
  const double probability = test_support::per_test(2.0 * (film.pixel_count() + 1));
  double all_hits = 0;
  double all_expected = 0;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    const glm::dvec3 mean = film.mean(pixel);
    const double hits = std::round(mean.z * kSamples / of_hit.z);
    const double expected = survival * pixel_form_factor(scene, pixel);
    EXPECT_GT(test_support::binomial_tail_bound(hits, kSamples, expected), probability)
        << "pixel " << pixel << ": " << hits << " of " << kSamples << " found the light, expected is "
        << expected * kSamples;
    EXPECT_NEAR(mean.x, hits * of_hit.x / kSamples, 1e-9);
    EXPECT_NEAR(mean.y, hits * of_hit.y / kSamples, 1e-9);
    EXPECT_NEAR(mean.z, hits * of_hit.z / kSamples, 1e-9);
    all_hits += hits;
    all_expected += expected;
  }
  // With unequal probabilities the sum varies less than a binomial one (Hoeffding 1963, theorem 1).
  const double share = all_expected / film.pixel_count();
  EXPECT_GT(test_support::binomial_tail_bound(all_hits, double(kSamples) * film.pixel_count(), share),
            probability);
}

/// Whether a pixel shows the light, whose edges lie on pixel borders: the film's height covers 8 units of
/// length at the light.
bool shows_light(const FilmSize& film, int pixel) {
  const double units = 8.0 / film.height;
  const double x = (pixel % film.width + 0.5 - 0.5 * film.width) * units;
  const double y = (pixel / film.width + 0.5 - 0.5 * film.height) * units;
  return std::abs(x) < PlaneAndLight::kLightHalfSide && std::abs(y) < PlaneAndLight::kLightHalfSide;
}

TEST(DirectLight, PixelsOfTheLightShowItsRadiance) {
  for (const Program program : {Program::segments, Program::full}) {
    const Scene scene = test_support::light_from_below(kValues, {40, 32});
    const Film film = render_natively(scene, render_options(program, 16)).film;
    int light_pixels = 0;
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
      const bool light = shows_light(scene.film, pixel);
      EXPECT_EQ(film.mean(pixel), light ? kValues.radiance : glm::dvec3(0.0)) << "pixel " << pixel;
      EXPECT_EQ(film.variance_of_mean(pixel), glm::dvec3(0.0)) << "pixel " << pixel;
      light_pixels += light;
    }
    EXPECT_EQ(light_pixels, 64);
  }
}

TEST(DirectLight, TheBackOfTheLightIsDark) {
  for (const Program program : {Program::segments, Program::full}) {
    const Scene scene = test_support::light_from_above(kValues, {40, 32});
    const Film film = render_natively(scene, render_options(program, 64)).film;
    int lit_pixels = 0;
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
      if (shows_light(scene.film, pixel)) {
        EXPECT_EQ(film.mean(pixel), glm::dvec3(0.0)) << "pixel " << pixel;
      }
      lit_pixels += film.mean(pixel).x > 0;
    }
    EXPECT_GT(lit_pixels, 200) << "the plane around it";
  }
}

TEST(DirectLight, TheBackOfTheLightLightsNothing) {
  for (const Program program : {Program::segments, Program::full}) {
    const Scene scene = test_support::plane_over_light(kValues, {24, 16});
    for (const bool cull : {false, true}) {
      testbench::RenderOptions options = render_options(program, 64);
      options.program.cull_shadow_rays = cull;
      const RenderResult result = render_natively(scene, options);
      EXPECT_EQ(result.film.rejected_samples(), 0u);
      for (const double value : result.film.rgb()) ASSERT_EQ(value, 0.0);
      const bool casts = program == Program::full && !cull;
      EXPECT_EQ(result.counts.shadow_rays, casts ? 24u * 16u * 64u : 0u);
    }
  }
}

}  // namespace direct_light_test
