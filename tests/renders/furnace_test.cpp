// Furnace test: in a closed enclosure with albedo a and emission e everywhere, the radiance is e / (1 - a) in
// every direction.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/statistics.hpp"

namespace furnace_test {

using path_tracer::Program;
using path_tracer::RadianceRecord;
using test_support::closed_cube;
using test_support::closed_sphere;
using test_support::FilmSize;
using test_support::native_paths;
using test_support::render_options;
using testbench::Film;
using testbench::render_natively;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

constexpr double kAlbedo = 0.5;
constexpr double kEmission = 0.5;

/// An upper bound of the probability that `paths` paths, which end at each vertex with probability `end`,
/// have a total of `vertices` vertices or one that is further from the mean on the same side.
double vertices_tail_bound(double vertices, double paths, double end) {
  const bool few = vertices * end < paths;
  // Few vertices: `vertices` trials contain all ends. Many vertices: without the last trial, which is an end,
  // one end is missing.
  return few ? test_support::binomial_tail_bound(paths, vertices, end)
             : test_support::binomial_tail_bound(paths - 1, vertices - 1, end);
}

TEST(Furnace, EveryPixelOfACubeIsOneWhenLightIsFoundByHittingIt) {
  const Scene scene = closed_cube(kAlbedo, kEmission, {24, 20});
  constexpr int kSamples = 512;
  const RenderResult result = render_natively(scene, render_options(Program::segments, kSamples));
  const Film& film = result.film;
  const double probability = test_support::per_test(2.0 * film.pixel_count());
  double all_vertices = 0;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    ASSERT_EQ(film.sample_count(pixel), std::uint64_t(kSamples));
    const glm::dvec3 mean = film.mean(pixel);
    EXPECT_EQ(mean.x, mean.y);
    EXPECT_EQ(mean.x, mean.z);
    // Albedo / survival is exactly 1, so a path contributes kEmission times its number of vertices.
    const double vertices = mean.x * kSamples / kEmission;
    EXPECT_EQ(vertices, std::floor(vertices)) << "pixel " << pixel;
    EXPECT_GT(vertices_tail_bound(vertices, kSamples, 1 - kAlbedo), probability)
        << "pixel " << pixel << " is " << mean.x << ", expected is 1";
    all_vertices += vertices;
  }
  EXPECT_EQ(all_vertices, double(result.counts.segments));
  EXPECT_GT(vertices_tail_bound(all_vertices, double(kSamples) * film.pixel_count(), 1 - kAlbedo),
            test_support::per_test(2))
      << "mean of the film " << all_vertices * kEmission / (double(kSamples) * film.pixel_count());
  EXPECT_EQ(film.rejected_samples(), 0u);
}

TEST(Furnace, WithoutRouletteEveryPathIsOne) {
  RenderOptions options = render_options(Program::segments, 4);
  options.program.roulette_start = 40;  // later vertices contribute 2^-40 on average
  const RenderResult result = render_natively(closed_cube(kAlbedo, kEmission, {40, 30}), options);
  EXPECT_GT(result.counts.folds, result.counts.paths);
  for (const double value : result.film.rgb()) ASSERT_NEAR(value, 1.0, 1e-10);
}

/// Tests every pixel and the whole film. Direct light from near points across an edge is rare and bright:
/// P(path > x) falls as x^-3/2, so the variance is infinite and no statistic is normal. So paths are clipped,
/// which reduces means by at most the given amounts, and are tested by a bound that holds for all bounded
/// variables.
void expect_ones(const Scene& scene, int samples, double clip, double clipped_of_film,
                 double clipped_of_pixel) {
  const std::vector<RadianceRecord> paths = native_paths(scene, render_options(Program::full, samples));
  const int pixels = scene.film.width * scene.film.height;
  ASSERT_EQ(paths.size(), std::size_t(samples) * std::size_t(pixels));
  std::vector<double> sums(std::size_t(pixels) + 1);
  std::vector<double> squares(sums.size());
  for (const RadianceRecord& path : paths) {
    ASSERT_EQ(path.radiance.x, path.radiance.y);
    ASSERT_EQ(path.radiance.x, path.radiance.z);
    const double value = std::min(path.radiance.x, clip);
    for (const std::size_t entry : {std::size_t(path.pixel), std::size_t(pixels)}) {
      sums[entry] += value;
      squares[entry] += value * value;
    }
  }
  const double probability = test_support::per_test(double(sums.size()));
  for (std::size_t entry = 0; entry < sums.size(); ++entry) {
    const bool film = entry == std::size_t(pixels);
    const double count = film ? double(paths.size()) : samples;
    const double mean = sums[entry] / count;
    const double variance = (squares[entry] - sums[entry] * mean) / (count - 1);
    const double error = test_support::bounded_mean_error(variance, count, clip, probability);
    const std::string where = film ? "the film" : "pixel " + std::to_string(entry);
    EXPECT_LT(mean - error, 1.0) << where << ": " << mean << " +- " << error;
    EXPECT_GT(mean + error, 1.0 - (film ? clipped_of_film : clipped_of_pixel))
        << where << ": " << mean << " +- " << error;
  }
}

TEST(Furnace, EveryPixelOfASphereIsOneWithDirectLight) {
  // The tail's weight is proportional to (edge length) * sin(edge angle)^3: for these 512 faces 1/50 of the
  // cube's.
  expect_ones(closed_sphere(kAlbedo, kEmission, 3, {8, 6}), 16384, 5.0, 0.005, 0.005);
}

TEST(Furnace, EveryPixelOfACubeIsOneWithDirectLight) {
  // In a separate simulation of 10^7 paths from random points, clipping removes 0.038; in pixels that show an
  // edge at most three times as much.
  expect_ones(closed_cube(kAlbedo, kEmission, {12, 10}), 16384, 8.5, 0.05, 0.115);
}

TEST(Furnace, PathsAreWorthEmissionOverOneLessAlbedo) {
  for (const double albedo : {0.1, 0.25, 0.5, 0.75, 0.9}) {
    const double emission = 0.3;
    const std::vector<RadianceRecord> paths =
        native_paths(closed_cube(albedo, emission, {40, 40}), render_options(Program::segments, 32));
    ASSERT_EQ(paths.size(), 40u * 40u * 32u);
    double vertices = 0;
    double sum = 0;
    for (const RadianceRecord& path : paths) {
      const double of_path = std::round(path.radiance.x / emission);
      ASSERT_GE(of_path, 1.0);
      ASSERT_NEAR(path.radiance.x, of_path * emission, 1e-12 * of_path);
      vertices += of_path;
      sum += path.radiance.x;
    }
    const auto count = double(paths.size());
    EXPECT_NEAR(sum / count, vertices * emission / count, 1e-10);
    EXPECT_GT(vertices_tail_bound(vertices, count, 1 - albedo), test_support::per_test(2 * 5))
        << "albedo " << albedo << ": mean " << sum / count << ", expected is " << emission / (1 - albedo);
  }
}

TEST(Furnace, WhiteSurfacesKeepTheMeanAndTheVariance) {
  for (const double albedo : {0.99, 0.999, 0.9999}) {
    const double emission = 1 - albedo;
    const std::vector<RadianceRecord> paths =
        native_paths(closed_cube(albedo, emission, {16, 16}), render_options(Program::segments, 8));
    double vertices = 0;
    for (const RadianceRecord& path : paths) {
      // Roulette at the albedo leaves each weight at 1, so a path is worth its vertices, whatever their
      // number.
      ASSERT_NEAR(path.radiance.x, std::round(path.radiance.x / emission) * emission, 1e-9 * path.radiance.x);
      vertices += std::round(path.radiance.x / emission);
    }
    EXPECT_GT(vertices_tail_bound(vertices, double(paths.size()), 1 - albedo), test_support::per_test(2 * 3))
        << "albedo " << albedo << ": mean " << vertices * emission / double(paths.size())
        << ", expected is 1";
  }
}

TEST(Furnace, RouletteBelowTheAlbedoKeepsTheMean) {
  RenderOptions options = render_options(Program::segments, 64);
  options.program.max_survival = 0.4;
  options.program.roulette_start = 2;
  constexpr double kWeight = kAlbedo / 0.4;
  const std::vector<RadianceRecord> paths = native_paths(closed_cube(kAlbedo, kEmission, {40, 40}), options);
  // A path with k vertices after the second has the mean and the variance of a geometric sum of growing
  // weights.
  constexpr double kVertices = 40;
  double mean = 0;
  double square = 0;
  for (double k = 0; k < kVertices; ++k) {
    const double probability = std::pow(0.4, k) * 0.6;
    const double value =
        kEmission * (1 + kAlbedo + kAlbedo * kAlbedo * (std::pow(kWeight, k + 1) - 1) / (kWeight - 1));
    mean += probability * value;
    square += probability * value * value;
  }
  ASSERT_NEAR(mean, 1.0, 1e-6);
  double sum = 0;
  for (const RadianceRecord& path : paths) sum += path.radiance.x;
  const auto count = double(paths.size());
  const double deviation = std::sqrt((square - mean * mean) / count);
  EXPECT_NEAR(sum / count, 1.0, test_support::normal_threshold(test_support::kFalseAlarm) * deviation);
}

TEST(Furnace, ShortSlotsFoldToTheSameImage) {
  for (const Program program : {Program::segments, Program::full}) {
    RenderOptions options = render_options(program, 8);
    options.program.roulette_start = 9;  // so that weights other than 1 occur before and after a fold
    const Scene scene = closed_cube(0.9, 0.1, {17, 13});
    const RenderResult long_slots = render_natively(scene, options);
    options.program.slot_vertices = 4;
    const RenderResult short_slots = render_natively(scene, options);
    EXPECT_GT(short_slots.counts.folds, short_slots.counts.paths);
    EXPECT_LT(long_slots.counts.folds, short_slots.counts.folds);
    // The bits may differ, because a path that is cut is rounded at other places.
    const std::vector<double> expected = long_slots.film.rgb();
    const std::vector<double> found = short_slots.film.rgb();
    for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_NEAR(found[i], expected[i], 1e-12 * expected[i]);
  }
}

TEST(Furnace, SeedsGiveImagesOfTheirOwn) {
  const Scene scene = closed_cube(kAlbedo, kEmission, {16, 16});
  const auto image = [&](std::uint64_t seed) {
    RenderOptions options = render_options(Program::full, 2);
    options.program.seed = seed;
    return render_natively(scene, options).film.sha256();
  };
  EXPECT_EQ(image(1), image(1));
  EXPECT_NE(image(1), image(2));
  EXPECT_NE(image(1), image(1 + (std::uint64_t{1} << 32)));
}

TEST(Furnace, SamplesAddUpFromPartsOfTheWork) {
  const Scene scene = closed_cube(kAlbedo, kEmission, {9, 7});
  RenderOptions options = render_options(Program::full, 6);
  const Film whole = render_natively(scene, options).film;
  options.work = {0, 2};
  Film parts = render_natively(scene, options).film;
  options.work = {2, 4};
  parts.merge(render_natively(scene, options).film);
  EXPECT_EQ(parts.sha256(), whole.sha256());
}

TEST(Furnace, FilmHoldsTheMeanOfThePaths) {
  const Scene scene = closed_cube(kAlbedo, kEmission, {9, 7});
  const RenderOptions options = render_options(Program::full, 5);
  Film film(scene.film, testbench::film_scale(scene));
  for (const RadianceRecord& path : native_paths(scene, options))
    ASSERT_TRUE(film.add(path.pixel, {path.radiance.x, path.radiance.y, path.radiance.z}));
  EXPECT_EQ(film.sha256(), render_natively(scene, options).film.sha256());
}

}  // namespace furnace_test
