#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include "testbench/film/film.hpp"

namespace film_test {

using testbench::Film;
using testbench::FilmSize;
using testbench::FilmSums;

struct Sample {
  int pixel;
  glm::dvec3 radiance;
};

/// Samples over 40 powers of two. Sums of them in double precision depend on the order.
std::vector<Sample> wild_samples(int pixels, int count) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> mantissa(0.5, 1.0);
  std::uniform_int_distribution<int> exponent(-35, 5);
  std::uniform_int_distribution<int> pixel(0, pixels - 1);
  std::vector<Sample> samples;
  for (int i = 0; i < count; ++i) {
    Sample sample{pixel(random), {}};
    for (int c = 0; c < 3; ++c) sample.radiance[c] = std::ldexp(mantissa(random), exponent(random));
    samples.push_back(sample);
  }
  return samples;
}

void expect_same_bits(const Film& a, const Film& b) {
  EXPECT_EQ(a.rgb(), b.rgb());
  EXPECT_EQ(a.sha256(), b.sha256());
  for (int pixel = 0; pixel < a.pixel_count(); ++pixel) {
    EXPECT_EQ(a.variance_of_mean(pixel), b.variance_of_mean(pixel));
    EXPECT_EQ(a.sample_count(pixel), b.sample_count(pixel));
  }
}

TEST(Film, does_not_depend_on_the_order_of_samples) {
  std::vector<Sample> samples = wild_samples(6, 3000);
  Film forward({3, 2}, 16.0);
  for (const Sample& s : samples) ASSERT_TRUE(forward.add(s.pixel, s.radiance));
  std::shuffle(samples.begin(), samples.end(), std::mt19937_64(3));
  Film shuffled({3, 2}, 16.0);
  for (const Sample& s : samples) ASSERT_TRUE(shuffled.add(s.pixel, s.radiance));
  expect_same_bits(forward, shuffled);
}

// Shows that the test above can fail: sums of the same samples in double precision depend on the order.
TEST(Film, plain_doubles_would_depend_on_the_order) {
  std::vector<Sample> samples = wild_samples(1, 3000);
  double forward = 0.0;
  for (const Sample& s : samples) forward += s.radiance.x;
  std::sort(samples.begin(), samples.end(),
            [](const Sample& a, const Sample& b) { return a.radiance.x < b.radiance.x; });
  double sorted = 0.0;
  for (const Sample& s : samples) sorted += s.radiance.x;
  EXPECT_NE(forward, sorted);
}

TEST(Film, does_not_depend_on_the_partition_into_merged_films) {
  const std::vector<Sample> samples = wild_samples(6, 3000);
  Film whole({3, 2}, 16.0);
  for (const Sample& s : samples) whole.add(s.pixel, s.radiance);
  whole.add(0, {-1.0, 0.0, 0.0});
  for (const std::size_t parts : {2U, 3U, 7U}) {
    std::vector<Film> films(parts, Film({3, 2}, 16.0));
    for (std::size_t i = 0; i < samples.size(); ++i)
      films[i * i % parts].add(samples[i].pixel, samples[i].radiance);
    films.back().add(0, {-1.0, 0.0, 0.0});
    Film merged({3, 2}, 16.0);
    for (auto film = films.rbegin(); film != films.rend(); ++film) merged.merge(*film);
    expect_same_bits(whole, merged);
    EXPECT_EQ(merged.rejected().negative, 1U);
  }
}

TEST(Film, mean_and_variance_are_those_of_the_samples) {
  Film film({1, 1}, 1.0);
  const double values[] = {0.5, 1.25, 3.0, 0.0};
  for (const double v : values) film.add(0, {v, 2.0 * v, 0.1});
  const double mean = 4.75 / 4.0;
  double deviation = 0.0;
  for (const double v : values) deviation += (v - mean) * (v - mean);
  EXPECT_EQ(film.mean(0).x, mean);
  EXPECT_EQ(film.mean(0).y, 2.0 * mean);
  EXPECT_EQ(film.mean(0).z, 0.1);  // the mean of equal samples is exact
  EXPECT_DOUBLE_EQ(film.variance_of_mean(0).x, deviation / 3.0 / 4.0);
  EXPECT_DOUBLE_EQ(film.variance_of_mean(0).y, 4.0 * deviation / 3.0 / 4.0);
  EXPECT_NEAR(film.variance_of_mean(0).z, 0.0, 0x1p-52);
  EXPECT_EQ(film.sample_count(0), 4U);
}

TEST(Film, keeps_a_small_variance_under_a_large_mean) {
  Film film({1, 1}, 1024.0);
  for (int i = 0; i < 1000; ++i) film.add(0, glm::dvec3(1024.0 + (i % 2 == 0 ? 0x1p-12 : -0x1p-12)));
  const double expected = 0x1p-24 * 1000.0 / 999.0 / 1000.0;
  EXPECT_NEAR(film.variance_of_mean(0).x, expected, 1e-6 * expected);
}

TEST(Film, without_samples_is_zero) {
  Film film({2, 1}, 1.0);
  film.add(1, {1.0, 1.0, 1.0});
  EXPECT_EQ(film.mean(0), glm::dvec3(0.0));
  EXPECT_EQ(film.variance_of_mean(0), glm::dvec3(0.0));
  EXPECT_EQ(film.variance_of_mean(1), glm::dvec3(0.0));
}

TEST(Film, cuts_bits_below_the_quantum_only) {
  Film film({1, 1}, 1.0);
  film.add(0, {0x1p-74, 0x1.8p-74, 0x1p-75});
  EXPECT_EQ(film.mean(0), glm::dvec3(0x1p-74, 0x1p-74, 0.0));
  Film tiny({1, 1}, 1.0);
  tiny.add(0, {std::numeric_limits<double>::denorm_min(), -0.0, std::numeric_limits<double>::min()});
  EXPECT_EQ(tiny.mean(0), glm::dvec3(0.0));
  EXPECT_FALSE(std::signbit(tiny.mean(0).y));
  EXPECT_EQ(tiny.rejected_samples(), 0U);
}

TEST(Film, holds_the_largest_sample_exactly_at_every_scale) {
  for (const double scale : {0x1p-40, 1.0, 0x1p40}) {
    Film film({1, 1}, scale);
    const double largest = film.max_radiance();
    EXPECT_EQ(largest, scale * 0x1p20);
    EXPECT_TRUE(film.add(0, glm::dvec3(largest)));
    EXPECT_TRUE(film.add(0, glm::dvec3(0.0)));
    EXPECT_EQ(film.mean(0), glm::dvec3(largest / 2.0));
    EXPECT_DOUBLE_EQ(film.variance_of_mean(0).x, largest * largest / 4.0);
    EXPECT_FALSE(film.add(0, glm::dvec3(std::nextafter(largest, 2.0 * largest))));
  }
}

// Reaches 2^32 samples by doubling: sums stay within 128 bits, and one more sample is refused.
TEST(Film, holds_two_to_the_32_samples_and_no_more) {
  Film film({1, 1}, 1.0);
  film.add(0, glm::dvec3(film.max_radiance()));
  for (int i = 0; i < 32; ++i) {
    const Film copy = film;
    film.merge(copy);
  }
  EXPECT_EQ(film.sample_count(0), Film::kMaxSamples);
  EXPECT_EQ(film.mean(0), glm::dvec3(film.max_radiance()));
  EXPECT_EQ(film.variance_of_mean(0), glm::dvec3(0.0));
  EXPECT_FALSE(film.add(0, glm::dvec3(1.0)));
  EXPECT_EQ(film.rejected().too_large, 1U);
  EXPECT_THROW(film.merge(film), std::overflow_error);
  EXPECT_EQ(film.sample_count(0), Film::kMaxSamples);
}

TEST(Film, refuses_and_counts_bad_samples_by_cause) {
  Film film({1, 1}, 1.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(film.add(0, {nan, 0.0, 0.0}));
  EXPECT_FALSE(film.add(0, {0.0, infinity, 0.0}));
  EXPECT_FALSE(film.add(0, {0.0, -1.0, -infinity}));
  EXPECT_FALSE(film.add(0, {0.0, 0.0, -1e-300}));
  EXPECT_FALSE(film.add(0, {1e300, 0.0, 0.0}));
  EXPECT_EQ(film.rejected().not_finite, 3U);
  EXPECT_EQ(film.rejected().negative, 1U);
  EXPECT_EQ(film.rejected().too_large, 1U);
  EXPECT_EQ(film.rejected_samples(), 5U);
  EXPECT_EQ(film.sample_count(0), 0U);
  EXPECT_EQ(film.mean(0), glm::dvec3(0.0));
}

TEST(Film, rgb_is_row_major) {
  Film film({2, 2}, 1.0);
  for (int pixel = 0; pixel < 4; ++pixel) film.add(pixel, {pixel, pixel + 0.25, pixel + 0.5});
  EXPECT_EQ(film.rgb(), (std::vector<double>{0, 0.25, 0.5, 1, 1.25, 1.5, 2, 2.25, 2.5, 3, 3.25, 3.5}));
}

// The digests of 24 zero bytes and of the little-endian bits of 1.0, 2.0, 0.5, computed with Python's
// hashlib.
TEST(Film, sha256_is_over_the_little_endian_bits) {
  Film film({1, 1}, 1.0);
  EXPECT_EQ(film.sha256(), "9d908ecfb6b256def8b49a7c504e6c889c4b0e41fe6ce3e01863dd7b61a20aa0");
  film.add(0, {1.0, 2.0, 0.5});
  EXPECT_EQ(film.sha256(), "c874c2cb3c1d42d80705bfd5d34d5c253d8733b8fbc46567815403ca579b7c0e");
}

TEST(Film, refuses_wrong_use) {
  EXPECT_THROW(Film({1, 1}, 3.0), std::invalid_argument);
  EXPECT_THROW(Film({1, 1}, 0.0), std::invalid_argument);
  EXPECT_THROW(Film({1, 1}, -1.0), std::invalid_argument);
  EXPECT_THROW(Film({1, 1}, 0x1p301), std::invalid_argument);
  EXPECT_THROW(Film({1, 1}, std::numeric_limits<double>::quiet_NaN()), std::invalid_argument);
  EXPECT_THROW(Film({1, 1}, std::numeric_limits<double>::infinity()), std::invalid_argument);
  EXPECT_THROW(Film({0, 1}, 1.0), std::invalid_argument);
  Film film({2, 2}, 1.0);
  EXPECT_THROW(film.add(4, glm::dvec3(0.0)), std::out_of_range);
  EXPECT_THROW(film.add(-1, glm::dvec3(0.0)), std::out_of_range);
  EXPECT_THROW(film.merge(Film({2, 1}, 1.0)), std::invalid_argument);
  EXPECT_THROW(film.merge(Film({2, 2}, 2.0)), std::invalid_argument);
}

TEST(Film, survives_the_way_to_another_process) {
  Film film({3, 2}, 16.0);
  for (const Sample& s : wild_samples(6, 300)) film.add(s.pixel, s.radiance);
  film.add(0, {-1.0, 0.0, 0.0});
  const Film copy = Film::from_bytes({3, 2}, 16.0, FilmSums::means_and_variances, film.bytes());
  expect_same_bits(film, copy);
  EXPECT_EQ(copy.rejected().negative, 1u);
  Film twice = film;
  twice.merge(copy);
  EXPECT_EQ(twice.sample_count(0), 2 * film.sample_count(0));
  EXPECT_THROW(Film::from_bytes({2, 2}, 16.0, FilmSums::means_and_variances, film.bytes()),
               std::invalid_argument);
  EXPECT_THROW(Film::from_bytes({3, 2}, 16.0, FilmSums::means_and_variances, ""), std::invalid_argument);
}

TEST(Film, of_means_alone_has_the_same_means) {
  Film both({3, 2}, 16.0);
  Film means({3, 2}, 16.0, FilmSums::means);
  for (const Sample& s : wild_samples(6, 300)) {
    both.add(s.pixel, s.radiance);
    means.add(s.pixel, s.radiance);
  }
  EXPECT_EQ(means.rgb(), both.rgb());
  EXPECT_EQ(means.sha256(), both.sha256());
  EXPECT_EQ(both.bytes().size() - means.bytes().size(), 6u * 3u * 16u) << "three numbers of 128 bits a pixel";
  EXPECT_THROW(means.variance_of_mean(0), std::logic_error);
  const Film copy = Film::from_bytes({3, 2}, 16.0, FilmSums::means, means.bytes());
  EXPECT_EQ(copy.sha256(), means.sha256());
  EXPECT_THROW(Film::from_bytes({3, 2}, 16.0, FilmSums::means, both.bytes()), std::invalid_argument);
  EXPECT_THROW(means.merge(both), std::invalid_argument);
  EXPECT_THROW(both.merge(means), std::invalid_argument);
  means.merge(copy);
  EXPECT_EQ(means.sha256(), both.sha256()) << "twice the sum of twice the samples";
  Film once({1, 1}, 1.0, FilmSums::means);
  once.add(0, glm::dvec3(0.5));
  EXPECT_EQ(once.variance_of_mean(0), glm::dvec3(0.0));
}

TEST(Film, splats_are_light_of_the_pixel_but_no_samples) {
  Film film({2, 1}, 1.0);
  ASSERT_TRUE(film.add_splat(0, {0.25, 0.5, 1.0}));  // before there is a sample
  EXPECT_EQ(film.mean(0), glm::dvec3(0.0));
  for (const double value : {1.0, 2.0, 3.0, 2.0}) {
    ASSERT_TRUE(film.add(0, glm::dvec3(value)));
    ASSERT_TRUE(film.add(1, glm::dvec3(0.0)));
  }
  const glm::dvec3 without = [] {
    Film samples({1, 1}, 1.0);
    for (const double value : {1.0, 2.0, 3.0, 2.0}) samples.add(0, glm::dvec3(value));
    return samples.variance_of_mean(0);
  }();
  ASSERT_TRUE(film.add_splat(0, {0.75, 0.5, 1.0}));
  EXPECT_EQ(film.sample_count(0), 4u);
  EXPECT_EQ(film.sample_count(1), 4u);
  EXPECT_EQ(film.mean(0), glm::dvec3(2.25, 2.25, 2.5));
  const glm::dvec3 of_splats = glm::dvec3(0.0625 + 0.5625, 0.5, 2.0) / 16.0;
  for (int channel = 0; channel < 3; ++channel)
    EXPECT_NEAR(film.variance_of_mean(0)[channel] - without[channel], of_splats[channel], 1e-15);
  EXPECT_FALSE(film.add_splat(1, {-1.0, 0.0, 0.0}));
  EXPECT_FALSE(film.add_splat(1, {std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}));
  EXPECT_EQ(film.rejected_samples(), 2u);
  EXPECT_THROW(film.add_splat(2, glm::dvec3(1.0)), std::out_of_range);
}

/// 6, 2 and no samples are 8 light paths for 3 pixels, wherever they begin: a splat counts 3 / 8.
TEST(Film, splats_are_divided_by_the_light_paths_of_all_pixels) {
  Film film({3, 1}, 1.0);
  for (int i = 0; i < 6; ++i) ASSERT_TRUE(film.add(0, glm::dvec3(0.5)));
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(film.add(1, glm::dvec3(0.25)));
  for (int pixel = 0; pixel < 3; ++pixel) ASSERT_TRUE(film.add_splat(pixel, glm::dvec3(2.0)));
  EXPECT_EQ(film.samples_for_each_pixel(), 8.0 / 3);
  EXPECT_EQ(film.mean(0), glm::dvec3(0.5 + 0.75));
  EXPECT_EQ(film.mean(1), glm::dvec3(0.25 + 0.75));
  EXPECT_EQ(film.mean(2), glm::dvec3(0.0)) << "no samples, so black";
  EXPECT_DOUBLE_EQ(film.variance_of_splats(0).x, 0.75 * 0.75);
  EXPECT_EQ(film.variance_of_mean(1), film.variance_of_splats(1)) << "its samples are equal";
  const Film sent = Film::from_bytes({3, 1}, 1.0, FilmSums::means_and_variances, film.bytes());
  EXPECT_EQ(sent.sha256(), film.sha256());
  film.merge(sent);
  EXPECT_EQ(film.sha256(), sent.sha256()) << "twice the samples and twice the splats";
}

TEST(Film, splats_do_not_depend_on_their_order_and_are_merged_and_sent) {
  for (const FilmSums sums : {FilmSums::means, FilmSums::means_and_variances}) {
    std::vector<Sample> splats = wild_samples(6, 1000);
    Film forward({3, 2}, 16.0, sums);
    Film with_samples({3, 2}, 16.0, sums);
    Film backward({3, 2}, 16.0, sums);
    for (int pixel = 0; pixel < 6; ++pixel) {
      forward.add(pixel, glm::dvec3(0.5));
      with_samples.add(pixel, glm::dvec3(0.5));
    }
    for (const Sample& s : splats) ASSERT_TRUE(forward.add_splat(s.pixel, s.radiance));
    std::reverse(splats.begin(), splats.end());
    for (const Sample& s : splats) ASSERT_TRUE(backward.add_splat(s.pixel, s.radiance));
    with_samples.merge(backward);
    EXPECT_EQ(with_samples.sha256(), forward.sha256());
    const Film sent = Film::from_bytes({3, 2}, 16.0, sums, forward.bytes());
    EXPECT_EQ(sent.sha256(), forward.sha256());
    EXPECT_EQ(sent.bytes(), forward.bytes());
    Film none({3, 2}, 16.0, sums);
    EXPECT_NE(none.bytes().size(), forward.bytes().size());
    EXPECT_THROW(Film::from_bytes({3, 2}, 16.0, sums, forward.bytes().substr(1)), std::invalid_argument);
  }
}

TEST(FilmScale, is_the_power_of_two_at_or_above_the_largest_emission) {
  const auto scale_of = [](double emission) {
    testbench::Scene scene;
    scene.materials.push_back({"dark", glm::dvec3(0.5), glm::dvec3(0.0)});
    scene.materials.push_back({"light", glm::dvec3(0.5), {0.0, emission, emission / 2.0}});
    return testbench::film_scale(scene);
  };
  EXPECT_EQ(scale_of(17.2), 32.0);
  EXPECT_EQ(scale_of(16.0), 16.0);
  EXPECT_EQ(scale_of(0.3), 0.5);
  EXPECT_EQ(scale_of(0x1p-99), 0x1p-99);
  EXPECT_EQ(scale_of(1e-200), 0x1p-300);
  EXPECT_EQ(scale_of(0x1p99), 0x1p99);
  EXPECT_NO_THROW(Film({1, 1}, scale_of(1e30)));
}

TEST(FilmScale, keeps_means_and_variances_of_dim_and_of_bright_scenes) {
  for (const int exponent : {-290, -130, -40, 0, 40, 100}) {
    const double unit = std::ldexp(1.0, exponent);
    Film film({1, 1}, unit);
    ASSERT_TRUE(film.add(0, glm::dvec3(0.1 * unit, 3 * unit, 0x1p19 * unit)));
    ASSERT_TRUE(film.add(0, glm::dvec3(0.2 * unit, 5 * unit, 0x1p18 * unit)));
    EXPECT_NEAR(film.mean(0).x / unit, 0.15, 1e-15) << exponent;
    EXPECT_EQ(film.mean(0).y / unit, 4.0) << exponent;
    EXPECT_EQ(film.mean(0).z / unit, 0x1.8p18) << exponent;
    EXPECT_EQ(film.variance_of_mean(0).y / unit / unit, 1.0) << exponent;
  }
}

}  // namespace film_test
