// Every combination of sampler and light sampling gives the right image, and stratified points need fewer
// samples.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "firmware/path_tracer/program/program_options.hpp"
#include "testbench/film/error_curve.hpp"
#include "testbench/film/light_pixels.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/statistics.hpp"

namespace samplers_test {

using path_tracer::LightSampling;
using path_tracer::Program;
using path_tracer::Sampler;
using test_support::render_options;
using testbench::Film;
using testbench::render_natively;
using testbench::RenderOptions;
using testbench::Scene;

struct Combination {
  Sampler sampler;
  LightSampling light_sampling;
  int roulette_start;

  std::string name() const {
    return std::string(path_tracer::name_of(sampler)) + ", " + path_tracer::name_of(light_sampling) +
           ", roulette from " + std::to_string(roulette_start);
  }
  RenderOptions options(int samples, std::uint64_t seed) const {
    RenderOptions result = render_options(Program::full, samples);
    result.program.sampler = sampler;
    result.program.light_sampling = light_sampling;
    result.program.roulette_start = roulette_start;
    result.program.seed = seed;
    return result;
  }
};

std::vector<Combination> combinations() {
  std::vector<Combination> all;
  for (const Sampler sampler : {Sampler::philox, Sampler::sobol})
    for (const LightSampling light_sampling : {LightSampling::area, LightSampling::solid_angle})
      for (const int roulette_start : {0, 3}) all.push_back({sampler, light_sampling, roulette_start});
  return all;
}

/// Compares the mean of a channel over pixels and seeds, all independent estimates, with the expected value.
struct Estimate {
  double mean = 0;
  double deviation = 0;
};
Estimate estimate(const Scene& scene, const Combination& combination, int samples, int seeds) {
  double sum = 0;
  double squares = 0;
  double count = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Film film = render_natively(scene, combination.options(samples, std::uint64_t(seed))).film;
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
      const double value = film.mean(pixel).x;
      sum += value;
      squares += value * value;
      ++count;
    }
  }
  const double mean = sum / count;
  return {mean, std::sqrt((squares / count - mean * mean) / (count - 1))};
}

/// Emission 0.5 and albedo 0.5 give radiance 1 in every direction. Triangles have all distances and slants,
/// and many lie partly below the horizon of a lit point.
TEST(Samplers, AClosedSphereIsOneWithEachOfThem) {
  const Scene scene = test_support::closed_sphere(0.5, 0.5, 2, {16, 12});
  for (const Combination& combination : combinations()) {
    const Estimate found = estimate(scene, combination, 64, 8);
    EXPECT_LT(found.deviation, 0.004) << combination.name() << ": too noisy to tell";
    EXPECT_NEAR(found.mean, 1.0, test_support::normal_threshold(test_support::per_test(8)) * found.deviation)
        << combination.name();
  }
}

/// In a cube some light comes from close to the lit point, across an edge. Sampling by area then has infinite
/// variance (furnace_test.cpp); by solid angle the variance is finite. The cube's faces are rectangles.
TEST(Samplers, AClosedCubeIsOneBySolidAngle) {
  const Scene scene = test_support::closed_cube(0.5, 0.5, {16, 12});
  for (const Combination& combination : combinations()) {
    if (combination.light_sampling == LightSampling::area) continue;
    const Estimate found = estimate(scene, combination, 64, 8);
    EXPECT_LT(found.deviation, 0.004) << combination.name() << ": too noisy to tell";
    EXPECT_NEAR(found.mean, 1.0, test_support::normal_threshold(test_support::per_test(4)) * found.deviation)
        << combination.name();
  }
}

/// Random triangles, some of which emit, cover many relative positions of lights and lit points.
TEST(Samplers, AllAgreeOnRandomTriangles) {
  const Scene scene = test_support::triangle_soup(24, 3, {16, 12});
  const Combination plain{Sampler::philox, LightSampling::area, 0};
  for (const Combination& combination : combinations()) {
    double sum = 0;
    double squares = 0;
    double count = 0;
    for (std::uint64_t seed = 1; seed <= 8; ++seed) {
      const Film a = render_natively(scene, combination.options(64, seed)).film;
      const Film b = render_natively(scene, plain.options(64, seed + 100)).film;
      for (int pixel = 0; pixel < a.pixel_count(); ++pixel) {
        const double difference = a.mean(pixel).x - b.mean(pixel).x;
        sum += difference;
        squares += difference * difference;
        ++count;
      }
    }
    const double deviation = std::sqrt(squares / count / count);
    EXPECT_LT(std::abs(sum / count), 5.5 * deviation) << combination.name();
  }
}

/// Mean squared error over the pixels that do not show the light. It is the variance between seeds, because
/// unbiased samplers differ only by their noise. With few samples large errors are rare, so more seeds are
/// used.
double mse(const Scene& scene, const Combination& combination, int samples) {
  const int seeds = std::clamp(4096 / samples, 2, 256);
  const std::vector<bool> left_out = testbench::light_pixels(scene);
  std::vector<glm::dvec3> sums(left_out.size(), glm::dvec3(0.0));
  double squares = 0;
  double pixels = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Film film = render_natively(scene, combination.options(samples, std::uint64_t(seed))).film;
    for (std::size_t pixel = 0; pixel < sums.size(); ++pixel) {
      if (left_out[pixel]) continue;
      const glm::dvec3 mean = film.mean(int(pixel));
      sums[pixel] += mean;
      squares += glm::dot(mean, mean);
      if (seed == 1) ++pixels;
    }
  }
  for (const glm::dvec3& sum : sums) squares -= glm::dot(sum, sum) / seeds;
  return squares / (seeds - 1) / (3 * pixels);
}

double rmse_slope(const Scene& scene, const Combination& combination) {
  std::vector<double> samples;
  std::vector<double> errors;
  for (int count = 1; count <= 16384; count *= 4) {  // spans 4.2 decades
    samples.push_back(count);
    errors.push_back(std::sqrt(mse(scene, combination, count)));
  }
  return testbench::log_log_slope(samples, errors);
}

/// Pixels this large show many surfaces, so most of the error depends on several pairs of numbers. Stratified
/// points make it smaller but hardly steeper.
TEST(Samplers, ErrorFallsAsOneOverTheRootOfTheSamplesOrFaster) {
  const Scene box = test_support::small_cornell_box({8, 8});
  constexpr double kScatter = 0.04;  // scatter of the slope: eight errors of 63 pixels each
  EXPECT_NEAR(rmse_slope(box, {Sampler::philox, LightSampling::area, 0}), -0.5, kScatter);
  EXPECT_LT(rmse_slope(box, {Sampler::sobol, LightSampling::solid_angle, 3}), -0.5 + kScatter);
  EXPECT_LT(mse(box, {Sampler::sobol, LightSampling::solid_angle, 3}, 64),
            0.75 * mse(box, {Sampler::philox, LightSampling::solid_angle, 3}, 64));
}

/// Direct light alone is a smooth function of its four numbers. Each pair is stratified, so the part of the
/// error that depends on one pair falls faster. The pairs are shuffled independently, so the part that
/// depends on both falls as with independent numbers.
TEST(Samplers, ErrorOfDirectLightFallsFasterThanThat) {
  const Scene plane = test_support::plane_under_light({{0.25, 0.5, 0.75}, {4.0, 2.0, 1.0}}, {12, 8});
  EXPECT_LT(rmse_slope(plane, {Sampler::sobol, LightSampling::area, 0}), -0.6);
  EXPECT_LT(rmse_slope(plane, {Sampler::sobol, LightSampling::solid_angle, 0}), -0.6);
}

/// The warp to the cosine removes nearly all variance of an unoccluded light.
TEST(Samplers, SolidAngleTakesTheVarianceOfAnOpenLight) {
  const Scene plane = test_support::plane_under_light({{0.25, 0.5, 0.75}, {4.0, 2.0, 1.0}}, {12, 8});
  const double by_area = mse(plane, {Sampler::philox, LightSampling::area, 0}, 256);
  const double by_angle = mse(plane, {Sampler::philox, LightSampling::solid_angle, 0}, 256);
  EXPECT_LT(by_angle, 0.2 * by_area);
}

}  // namespace samplers_test
