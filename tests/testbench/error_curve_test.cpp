#include "testbench/film/error_curve.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "testbench/film/image_agreement.hpp"
#include "testbench/film/light_pixels.hpp"

namespace error_curve_test {

using testbench::agreement_of;
using testbench::ExrFilm;
using testbench::Film;
using testbench::FilmSize;
using testbench::image_error;
using testbench::ImageAgreement;
using testbench::ImageError;
using testbench::Scene;

/// A film with one sample per pixel.
Film film_of(FilmSize size, const std::vector<double>& rgb) {
  Film film(size, 1.0);
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    const std::size_t i = 3 * std::size_t(pixel);
    film.add(pixel, {rgb[i], rgb[i + 1], rgb[i + 2]});
  }
  return film;
}

ExrFilm reference_of(FilmSize size, std::vector<float> rgb, float variance) {
  ExrFilm reference;
  reference.width = size.width;
  reference.height = size.height;
  reference.variance.assign(rgb.size(), variance);
  reference.rgb = std::move(rgb);
  return reference;
}

TEST(ErrorCurve, ErrorOfKnownValues) {
  const Film film = film_of({2, 1}, {1, 2, 3, 9, 9, 9});
  const ExrFilm reference = reference_of({2, 1}, {1, 1, 1, 0, 0, 0}, 0);
  const ImageError error = image_error(film, reference, {true, false});
  EXPECT_DOUBLE_EQ(error.mse, (0 + 1 + 4) / 3.0);
  EXPECT_DOUBLE_EQ(error.relative_mse, (1 + 4) / 1.01 / 3.0);
  EXPECT_DOUBLE_EQ(error.mean_bias[0], 0);
  EXPECT_DOUBLE_EQ(error.mean_bias[1], 1);
  EXPECT_DOUBLE_EQ(error.mean_bias[2], 2);
}

TEST(ErrorCurve, TheReferencesVarianceIsSubtracted) {
  const Film film = film_of({1, 1}, {1, 2, 3});
  const ImageError error = image_error(film, reference_of({1, 1}, {1, 1, 1}, 0.25), {true});
  EXPECT_DOUBLE_EQ(error.mse, 5 / 3.0 - 0.25);
}

/// With a noisy reference of few samples, the error of noisy films is the films' own variance.
TEST(ErrorCurve, NoiseOfTheReferenceDoesNotShow) {
  const FilmSize size{64, 64};
  std::mt19937_64 random(11);
  std::normal_distribution<double> normal(0.0, 0.1);
  const auto noisy = [&](int samples) {
    Film film(size, 16.0);
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel)
      for (int i = 0; i < samples; ++i)
        film.add(pixel, {5 + normal(random), 6 + normal(random), 7 + normal(random)});
    return film;
  };
  const Film truth = noisy(16);
  ExrFilm reference = reference_of(size, {}, 0);
  for (int pixel = 0; pixel < truth.pixel_count(); ++pixel) {
    for (int channel = 0; channel < 3; ++channel) {
      reference.rgb.push_back(float(truth.mean(pixel)[channel]));
      reference.variance.push_back(float(truth.variance_of_mean(pixel)[channel]));
    }
  }
  const std::vector<bool> all(std::size_t(truth.pixel_count()), true);
  std::vector<double> samples;
  std::vector<double> errors;
  for (const int count : {1, 4, 16, 64}) {
    const double expected = 0.01 / count;
    const double found = image_error(noisy(count), reference, all).mse;
    // There are 12,288 values. The squared difference scatters by sqrt(2) of its mean, which includes the
    // reference's variance.
    EXPECT_NEAR(found, expected, 4.5 * std::sqrt(2.0 / 12288) * (expected + 0.01 / 16)) << count;
    samples.push_back(count);
    errors.push_back(std::sqrt(found));
  }
  EXPECT_NEAR(testbench::log_log_slope(samples, errors), -0.5, 0.02);
}

TEST(ErrorCurve, SlopesOfPowersAreTheirExponents) {
  const std::vector<double> x{1, 2, 4, 8, 16};
  for (const double exponent : {-1.0, -0.5, 0.0, 2.0}) {
    std::vector<double> y;
    for (const double value : x) y.push_back(3 * std::pow(value, exponent));
    EXPECT_NEAR(testbench::log_log_slope(x, y), exponent, 1e-12);
  }
}

TEST(ErrorCurve, PointsWithoutAPositiveErrorAreLeftOutOfTheSlope) {
  EXPECT_NEAR(testbench::log_log_slope({1, 2, 4, 8}, {1, 0.5, -1, std::nan("")}), -1.0, 1e-12);
  EXPECT_TRUE(std::isnan(testbench::log_log_slope({1, 2}, {1, -1})));
  EXPECT_TRUE(std::isnan(testbench::log_log_slope({}, {})));
  EXPECT_TRUE(std::isnan(testbench::log_log_slope({2, 2}, {1, 3})));
}

TEST(ErrorCurve, CostIsErrorTimesTime) {
  ImageError error;
  error.mse = 2e-4;
  EXPECT_DOUBLE_EQ(testbench::cost_of_error(error, 5.0), 1e-3);
}

/// A camera at the origin that looks along +z. At depth 1 one unit is half the film's height.
Scene light_scene(const glm::dvec3 (&corners)[3], FilmSize film) {
  Scene scene;
  scene.camera.direction = {0, 0, 1};
  scene.camera.up = {0, 1, 0};
  scene.camera.vertical_field_of_view_radians = 2 * std::atan(1.0);
  scene.film = film;
  scene.materials = {{"light", glm::dvec3(0.5), glm::dvec3(1.0)}, {"grey", glm::dvec3(0.5), glm::dvec3(0.0)}};
  scene.triangles = {{{corners[0], corners[1], corners[2]}, 0}};
  return scene;
}

int marked(const Scene& scene) {
  const std::vector<bool> pixels = testbench::light_pixels(scene);
  return int(std::count(pixels.begin(), pixels.end(), true));
}

TEST(LightPixels, AreThoseThatATriangleTouches) {
  // A triangle that covers half of the picture, cut along its diagonal, and faces the camera. Right is -x
  // here.
  Scene scene = light_scene({{1, 1, 1}, {1, -1, 1}, {-1, -1, 1}}, {8, 8});
  EXPECT_EQ(marked(scene), 36);  // 28 pixels below the diagonal and 8 on it
  std::swap(scene.triangles[0].vertex[1], scene.triangles[0].vertex[2]);
  EXPECT_EQ(marked(scene), 0) << "its back emits nothing";
}

TEST(LightPixels, OfAnOrthographicCameraDoNotDependOnTheDistance) {
  for (const double z : {0.5, 1.0, 1000.0}) {
    Scene scene = light_scene({{1, 1, z}, {1, -1, z}, {-1, -1, z}}, {8, 8});
    scene.camera.orthographic_height = 2.0;
    EXPECT_EQ(marked(scene), 36) << z;
    scene.camera.orthographic_height = 4.0;  // half as large: 6 pixels below the diagonal and 4 on it
    EXPECT_EQ(marked(scene), 10) << z;
    scene.camera.position.z = z + 1;
    EXPECT_EQ(marked(scene), 0) << "behind the film";
  }
}

TEST(LightPixels, SurfacesThatDoNotEmitAreNone) {
  Scene scene = light_scene({{1, 1, 1}, {1, -1, 1}, {-1, -1, 1}}, {8, 8});
  scene.triangles.push_back(
      {{scene.triangles[0].vertex[0], scene.triangles[0].vertex[2], scene.triangles[0].vertex[1]}, 0});
  EXPECT_EQ(marked(scene), 36);
  for (auto& triangle : scene.triangles) triangle.material = 1;
  EXPECT_EQ(marked(scene), 0);
}

TEST(LightPixels, TrianglesBehindTheCameraAreNoneAndThroughItAreClipped) {
  Scene behind = light_scene({{1, 1, -1}, {1, -1, -1}, {-1, -1, -1}}, {8, 8});
  behind.triangles.push_back(
      {{behind.triangles[0].vertex[0], behind.triangles[0].vertex[2], behind.triangles[0].vertex[1]}, 0});
  EXPECT_EQ(marked(behind), 0);
  // A floor one unit below the camera, from behind it to far ahead, covers nearly the lower half of the
  // picture.
  Scene floor = light_scene({{-1e6, -1, -5}, {0, -1, 1e6}, {1e6, -1, -5}}, {8, 8});
  EXPECT_EQ(marked(floor), 32);
}

constexpr FilmSize kAgreementSize{20, 12};

/// A film of noise of deviation 0.5 around 3, to which `shift` of a pixel is added.
template <class Shift>
Film noisy_film(std::uint64_t seed, int samples, Shift&& shift) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(3.0, 0.5);
  Film film(kAgreementSize, 16.0);
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel)
    for (int i = 0; i < samples; ++i)
      film.add(pixel, glm::dvec3(noise(random), noise(random), noise(random)) + shift(pixel));
  return film;
}

glm::dvec3 nothing(int) {
  return glm::dvec3(0);
}

TEST(ImageAgreement, OfEqualMeansHoldsAndIsInStandardErrors) {
  const ImageAgreement agreement = agreement_of(noisy_film(1, 64, nothing), noisy_film(2, 100, nothing));
  EXPECT_TRUE(agreement.holds()) << agreement.text();
  EXPECT_EQ(agreement.tiles, 6);
  EXPECT_NEAR(agreement.tile_rms_z, 1, 4.0 / std::sqrt(2.0 * 18)) << "of 18 values";
  // Variances of 240 pixels of 64 and 100 samples scatter by 1 %, their roots by half of that.
  const double expected = 0.5 / 3 * std::sqrt((1.0 / 64 + 1.0 / 100) / 240);
  for (const double error : agreement.standard_error) EXPECT_NEAR(error, expected, 0.025 * expected);
}

/// One in a hundred, everywhere: too little for a tile, enough for the image.
TEST(ImageAgreement, FailsForABiasOfTheWholeImage) {
  const ImageAgreement agreement = agreement_of(
      noisy_film(1, 200, nothing), noisy_film(2, 200, [](int) { return glm::dvec3(0.03, 0, 0); }));
  EXPECT_FALSE(agreement.holds());
  EXPECT_LT(agreement.largest_tile_z, ImageAgreement::kLargestTileZ);
  EXPECT_GT(agreement.image_z[0], ImageAgreement::kLargestImageZ);
  EXPECT_NEAR(agreement.relative_difference[0], 0.01, 4 * agreement.standard_error[0]);
}

/// What one corner has too much, another has too little.
TEST(ImageAgreement, FailsForABiasOfATile) {
  const auto shift = [](int pixel) {
    if (pixel % 20 < 8 && pixel / 20 < 8) return glm::dvec3(0, 0.1, 0);
    if (pixel % 20 >= 8 && pixel % 20 < 16 && pixel / 20 < 8) return glm::dvec3(0, -0.1, 0);
    return glm::dvec3(0);
  };
  const ImageAgreement agreement = agreement_of(noisy_film(1, 200, nothing), noisy_film(2, 200, shift));
  EXPECT_FALSE(agreement.holds());
  EXPECT_LT(std::abs(agreement.image_z[1]), ImageAgreement::kLargestImageZ);
  EXPECT_GT(agreement.largest_tile_z, ImageAgreement::kLargestTileZ);
}

TEST(ImageAgreement, WhatDoesNotVaryMustBeEqual) {
  const auto constant = [](double value) {
    Film film(kAgreementSize, 1.0);
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel)
      for (int i = 0; i < 2; ++i) film.add(pixel, glm::dvec3(value));
    return film;
  };
  EXPECT_TRUE(agreement_of(constant(0.5), constant(0.5)).holds());
  EXPECT_FALSE(agreement_of(constant(0.5), constant(0.5 + 1e-12)).holds());
}

}  // namespace error_curve_test
