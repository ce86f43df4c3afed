#include "testbench/sampling/adaptive_plan.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "testbench/sampling/error_estimate.hpp"

namespace adaptive_plan_test {

using testbench::AdaptivePlan;
using testbench::Film;
using testbench::FilmSize;
using testbench::MeanSamples;
using testbench::ShapedPlan;

constexpr FilmSize kSize{32, 16};
constexpr std::size_t kPixels = 32 * 16;

/// Samples that are 1 + spread and 1 - spread in turn; spread is 0.8 in the left half and 0.2 in the right
/// one.
void add_samples(Film& film, int pixel, int samples) {
  const double spread = pixel % kSize.width < kSize.width / 2 ? 0.8 : 0.2;
  for (int i = 0; i < samples; ++i) film.add(pixel, glm::dvec3(1 + (i % 2 == 0 ? spread : -spread)));
}

Film film_of(int samples) {
  Film film(kSize, 1.0);
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) add_samples(film, pixel, samples);
  return film;
}

int pixel_at(int column, int row) {
  return row * kSize.width + column;
}

double sum(const MeanSamples& samples) {
  return std::accumulate(samples.begin(), samples.end(), 0.0);
}

TEST(ShapedPlan, DoublesUntilAllSamplesAreThere) {
  ShapedPlan plan({1.0, 0.5}, 10);
  MeanSamples done = {0, 0};
  std::vector<double> passes;
  while (const auto next = plan.next(done)) {
    done = *next;
    EXPECT_EQ(done[1], 0.5 * done[0]);
    passes.push_back(done[0]);
  }
  EXPECT_EQ(passes, (std::vector<double>{1, 2, 4, 8, 10}));
}

TEST(ShapedPlan, ComesBackToWholeSamplesAfterAPassCutShort) {
  const ShapedPlan plan({1.0}, 10);
  EXPECT_EQ(plan.next({0.3}), MeanSamples{0.6});
  EXPECT_EQ(plan.next({0.6}), MeanSamples{1});
  EXPECT_EQ(plan.next({1.7}), MeanSamples{3});
}

TEST(ErrorEstimate, IsTheRelativeDeviationOfASample) {
  const int samples = 64;
  const std::vector<double> deviations = testbench::sample_deviations(film_of(samples)).of_sample;
  const double unbiased = double(samples) / (samples - 1);
  const double bound = 1 + testbench::kDarkShare * testbench::kDarkShare;
  EXPECT_NEAR(deviations[std::size_t(pixel_at(5, 8))], 0.8 * std::sqrt(unbiased / bound), 1e-12);
  const double mean = std::accumulate(deviations.begin(), deviations.end(), 0.0) / double(kPixels);
  EXPECT_NEAR(deviations[std::size_t(pixel_at(28, 8))], 0.2 * std::sqrt(unbiased / bound), 1e-12);
  EXPECT_LT(testbench::kLeastDeviation * mean, 0.2) << "the bound did not act";
}

TEST(ErrorEstimate, OfAPixelDependsOnNoneOfItsOwnSamples) {
  const Film film = film_of(8);
  Film other(kSize, 1.0);
  const int pixel = pixel_at(20, 7);
  for (int i = 0; i < film.pixel_count(); ++i) {
    if (i != pixel) add_samples(other, i, 8);
  }
  // The same mean, so that the picture's is the same too.
  for (int i = 0; i < 8; ++i) other.add(pixel, glm::dvec3(i == 0 ? 8.0 : 0.0));
  const std::vector<double> before = testbench::sample_deviations(film).of_sample;
  const std::vector<double> after = testbench::sample_deviations(other).of_sample;
  EXPECT_EQ(before[std::size_t(pixel)], after[std::size_t(pixel)]);
  EXPECT_LT(before[std::size_t(pixel + 1)], after[std::size_t(pixel + 1)]);
  EXPECT_EQ(before[std::size_t(pixel + 5)], after[std::size_t(pixel + 5)]);
}

TEST(ErrorEstimate, GivesUpNoPixelWhoseSamplesAreEqual) {
  Film film(kSize, 1.0);
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    const bool is_noisy = pixel % kSize.width < 4;
    for (int i = 0; i < 8; ++i) film.add(pixel, glm::dvec3(is_noisy && i == 0 ? 8 : 1));
  }
  const std::vector<double> deviations = testbench::sample_deviations(film).of_sample;
  EXPECT_GT(deviations[std::size_t(pixel_at(25, 8))], 0);
}

/// What light paths bring to the right half is lowered by samples of any pixel: they are no reason to put
/// samples there, but part of the error.
TEST(ErrorEstimate, TellsSplatsFromThePixelsOwnSamples) {
  Film film = film_of(8);
  const testbench::SampleDeviations without = testbench::sample_deviations(film);
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel)
    for (int i = 0; i < 8; ++i) film.add_splat(pixel, glm::dvec3(0.5));
  const testbench::SampleDeviations with = testbench::sample_deviations(film);
  const std::size_t pixel = std::size_t(pixel_at(5, 8));
  EXPECT_EQ(without.of_splats[pixel], 0);
  const double bound = 1 + testbench::kDarkShare * testbench::kDarkShare;
  // The mean is 1.5 times as large, and a light path brings 0.5 with certainty: 0.25 / 1.5^2.
  EXPECT_NEAR(with.of_sample[pixel], without.of_sample[pixel] / 1.5, 1e-12);
  EXPECT_NEAR(with.of_splats[pixel], std::sqrt(0.25 / bound) / 1.5, 1e-12);

  const std::vector<double> even(kPixels, 1.0);
  const testbench::SampleDeviations both = {std::vector<double>(kPixels, 0.0),
                                            std::vector<double>(kPixels, 0.5)};
  MeanSamples uneven(kPixels, 1.0);
  uneven[0] = 1.0 + 3.0 * double(kPixels);
  EXPECT_NEAR(testbench::picture_error(both, even, uneven), 0.25, 1e-12) << "four paths for each pixel";
}

TEST(AdaptivePlan, PutsSamplesInProportionToTheDeviation) {
  AdaptivePlan plan(std::vector<double>(kPixels, 1.0), 1 << 20, 0.01);
  MeanSamples done(kPixels, 0.0);
  Film film(kSize, 1.0);
  double paths = 0;
  int passes = 0;
  while (const auto next = plan.next(done, film)) {
    for (std::size_t pixel = 0; pixel < kPixels; ++pixel) {
      const int before = int(std::floor(done[pixel] + 0.5));
      EXPECT_GE((*next)[pixel], done[pixel]);
      add_samples(film, int(pixel), int(std::floor((*next)[pixel] + 0.5)) - before);
    }
    EXPECT_LE(sum(*next), std::max(2.001 * paths, double(kPixels))) << "a pass at most doubles the paths";
    paths = sum(*next);
    done = *next;
    ASSERT_LT(++passes, 40);
  }
  EXPECT_LE(*plan.error(), 0.01);
  EXPECT_GT(*plan.error(), 0.009) << "no more paths than it takes";
  EXPECT_NEAR(done[std::size_t(pixel_at(5, 8))] / done[std::size_t(pixel_at(28, 8))], 4, 0.1);
  // Neyman: (sum of deviations)^2 / (pixels * error^2), and a tenth for the border between the halves.
  const double bound = 1 + testbench::kDarkShare * testbench::kDarkShare;
  const double fewest = std::pow(kPixels * (0.8 + 0.2) / 2, 2) / bound / (kPixels * 1e-4);
  EXPECT_NEAR(paths / fewest, 1, 0.1);
}

TEST(AdaptivePlan, StopsAtTheMostSamplesAndWhereNothingIsImportant) {
  std::vector<double> importance(kPixels, 1.0);
  importance[3] = 0;
  importance[4] = 0.5;
  AdaptivePlan plan(importance, 64, 1e-6);
  MeanSamples done(kPixels, 0.0);
  Film film(kSize, 1.0);
  int passes = 0;
  while (const auto next = plan.next(done, film)) {
    for (std::size_t pixel = 0; pixel < kPixels; ++pixel)
      add_samples(film, int(pixel), int((*next)[pixel]) - int(done[pixel]));
    done = *next;
    ASSERT_LT(++passes, 20);
  }
  EXPECT_EQ(done[3], 0);
  EXPECT_EQ(done[4], 32);
  EXPECT_EQ(done[5], 64);
  EXPECT_GT(*plan.error(), 1e-6);
}

TEST(AdaptivePlan, MakesNoPassForAPictureWithoutNoise) {
  AdaptivePlan plan(std::vector<double>(kPixels, 1.0), 1000, 0.01);
  Film film(kSize, 1.0);
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel)
    for (int i = 0; i < AdaptivePlan::kFirstSamples; ++i) film.add(pixel, glm::dvec3(0.5));
  EXPECT_EQ(plan.next(MeanSamples(kPixels, AdaptivePlan::kFirstSamples), film), std::nullopt);
}

}  // namespace adaptive_plan_test
