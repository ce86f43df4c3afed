// Two renders of one scene agree within their noise, or do not.

#include "testbench/film/image_agreement.hpp"

#include <gtest/gtest.h>

#include <random>

namespace image_agreement_test {

using testbench::agreement_of;
using testbench::Film;
using testbench::FilmSize;
using testbench::ImageAgreement;

constexpr FilmSize kSize{20, 12};

/// A film of noise of deviation 0.5 around 3, to which `shift` of a pixel is added.
template <class Shift>
Film noisy_film(std::uint64_t seed, int samples, Shift&& shift) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(3.0, 0.5);
  Film film(kSize, 16.0);
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
    Film film(kSize, 1.0);
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel)
      for (int i = 0; i < 2; ++i) film.add(pixel, glm::dvec3(value));
    return film;
  };
  EXPECT_TRUE(agreement_of(constant(0.5), constant(0.5)).holds());
  EXPECT_FALSE(agreement_of(constant(0.5), constant(0.5 + 1e-12)).holds());
}

}  // namespace image_agreement_test
