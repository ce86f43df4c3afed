// A light out of several candidates: the same mean as a light by chance alone, the same image however it is
// made, and less noise where lights are many.

#include <gtest/gtest.h>

#include <cmath>

#include "testbench/mono_image/scene_features.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/statistics.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace light_candidates_test {

using path_tracer::Estimator;
using path_tracer::Program;
using path_tracer::Sampler;
using path_tracer::Shading;
using path_tracer::Traversal;
using testbench::Film;
using testbench::Light;
using testbench::LightKind;
using testbench::RenderOptions;
using testbench::Scene;

class LightCandidates : public test_support::SystemCFixture {};

constexpr int kCounts[] = {2, 4, 8};

void add_square(Scene& scene, const glm::dvec3& corner, const glm::dvec3& edge1, const glm::dvec3& edge2,
                std::int32_t material) {
  scene.triangles.push_back({{corner, corner + edge1, corner + edge1 + edge2}, material});
  scene.triangles.push_back({{corner, corner + edge1 + edge2, corner + edge2}, material});
}

/// A floor and a wall of different materials under a grid of lamps that face down. The camera sees their
/// dark backs.
Scene under_lamps(int rows, testbench::FilmSize film) {
  Scene scene;
  scene.name = "lamps";
  scene.film = film;
  scene.camera.position = {0, 2, 7};
  scene.camera.direction = glm::normalize(glm::dvec3(0, -0.2, -1));
  scene.camera.up = {0, 1, 0};
  scene.materials = {{"grey", {0.5, 0.6, 0.7}, glm::dvec3(0.0)},
                     {"metal", {0.9, 0.8, 0.6}, glm::dvec3(0.0)},
                     {"weak", glm::dvec3(0.0), {1, 2, 3}},
                     {"strong", glm::dvec3(0.0), {30, 20, 10}}};
  add_square(scene, {-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, 0);
  add_square(scene, {-3, 0, -3}, {6, 0, 0}, {0, 4, 0}, 1);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < rows; ++column) {
      const double step = 5.0 / rows;
      const glm::dvec3 corner(-2.5 + column * step, 1.0 + 0.3 * ((row + column) % 4), -2.5 + row * step);
      const double side = 0.2 * step;
      add_square(scene, corner, {side, 0, 0}, {0, 0, side}, 2 + (row * column) % 2);
    }
  return scene;
}

Light light_of(LightKind kind, const glm::dvec3& position, double intensity) {
  Light light;
  light.kind = kind;
  light.position = position;
  light.direction = glm::normalize(glm::dvec3(-0.3, -1, -0.2));
  light.intensity = glm::dvec3(intensity);
  return light;
}

/// Lights of every kind, one of them behind the wall, one a lamp that faces up.
Scene under_every_kind(testbench::FilmSize film) {
  Scene scene = under_lamps(2, film);
  add_square(scene, {1, 0.1, 1}, {0.2, 0, 0}, {0, 0, -0.2}, 3);
  scene.materials[1].metallic = 1.0;
  scene.materials[1].roughness = 0.4;
  scene.lights = {light_of(LightKind::point, {-1, 1, 2}, 4.0), light_of(LightKind::point, {0, 1, -4}, 50.0),
                  light_of(LightKind::spot, {2, 3, 0}, 20.0), light_of(LightKind::directional, {}, 0.5),
                  light_of(LightKind::sun, {}, 1.0)};
  scene.lights[2].inner_cone_radians = 0.2;
  scene.lights[2].outer_cone_radians = 0.9;
  scene.lights[4].angular_diameter_radians = 0.1;
  testbench::RadianceImage sky{8, 4, {}};
  for (int i = 0; i < 3 * sky.width * sky.height; ++i) sky.rgb.push_back(i % 7 == 0 ? 2.0f : 0.1f);
  scene.environment.image = sky;
  return scene;
}

RenderOptions options_for(int candidates, int samples) {
  RenderOptions options = test_support::render_options(Program::full, samples);
  options.chip.poly.sram_bytes = 32768;
  options.program.light_candidates = candidates;
  return options;
}

struct Estimate {
  double mean = 0;
  double variance = 0;  ///< of the mean; with independent samples
};

Estimate estimate(const Scene& scene, RenderOptions options) {
  options.program.sampler = Sampler::philox;
  const Film film = testbench::render_natively(scene, options).film;
  Estimate estimate;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    estimate.mean += film.mean(pixel).x / film.pixel_count();
    estimate.variance += film.variance_of_mean(pixel).x / film.pixel_count() / film.pixel_count();
  }
  return estimate;
}

void expect_same_mean(const Scene& scene, Estimator estimator) {
  RenderOptions options = options_for(1, 512);
  options.program.estimator = estimator;
  const Estimate one = estimate(scene, options);
  for (const int candidates : kCounts) {
    options.program.light_candidates = candidates;
    options.program.seed = std::uint64_t(100 + candidates);
    const Estimate many = estimate(scene, options);
    const double deviation = std::sqrt(one.variance + many.variance);
    EXPECT_LT(deviation, 0.02 * one.mean) << "too noisy to tell";
    EXPECT_NEAR(many.mean, one.mean, test_support::normal_threshold(test_support::per_test(9)) * deviation)
        << candidates << " candidates, estimator " << int(estimator);
  }
}

TEST_F(LightCandidates, LeaveTheMeanAsItIs) {
  expect_same_mean(under_lamps(4, {16, 12}), Estimator::light);
  expect_same_mean(under_every_kind({16, 12}), Estimator::mis);
  expect_same_mean(under_every_kind({16, 12}), Estimator::per_lobe);
}

/// Adds a lamp in a closed box of grey walls.
void add_sealed_lamp(Scene& scene, double emission) {
  scene.materials.push_back({"sealed", glm::dvec3(0.0), glm::dvec3(emission)});
  const glm::dvec3 at(2.0, 0.5, 2.0);
  const glm::dvec3 edges[3] = {{0.4, 0, 0}, {0, 0.4, 0}, {0, 0, 0.4}};
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec3& edge1 = edges[(axis + 1) % 3];
    const glm::dvec3& edge2 = edges[(axis + 2) % 3];
    add_square(scene, at, edge2, edge1, 0);
    add_square(scene, at + edges[axis], edge1, edge2, 0);
  }
  add_square(scene, at + glm::dvec3(0.1, 0.2, 0.1), {0.1, 0, 0}, {0, 0, 0.1},
             static_cast<std::int32_t>(scene.materials.size()) - 1);
}

/// Beside an emission of 1e8 a film keeps too few digits of the others' squares to tell variances.
TEST_F(LightCandidates, OfAHiddenLightHideNoOther) {
  for (const double emission : {1e4, 1e8}) {
    Scene scene = under_lamps(2, {16, 12});
    add_sealed_lamp(scene, emission);
    const Estimate one = estimate(scene, options_for(1, 256));
    for (const int candidates : kCounts) {
      RenderOptions options = options_for(candidates, 256);
      options.program.seed = std::uint64_t(200 + candidates);
      const Estimate many = estimate(scene, options);
      EXPECT_NEAR(many.mean, one.mean, 0.01 * one.mean) << candidates << " candidates, emission " << emission;
      if (emission > 1e4) continue;
      EXPECT_LT(many.variance, 1.5 * one.variance) << candidates << " candidates";
    }
  }
}

/// All candidates are the one light, and the factor is 1 whatever the estimate.
TEST_F(LightCandidates, OfASingleLightAreThatLight) {
  const Scene scene = test_support::plane_under_light({{0.25, 0.5, 0.75}, {4.0, 2.0, 1.0}}, {8, 6});
  for (const int candidates : kCounts) {
    RenderOptions options = options_for(candidates, 256);
    options.program.light_sampling =
        path_tracer::LightSampling::solid_angle;  // makes two triangles one light
    const Estimate many = estimate(scene, options);
    options.program.light_candidates = 1;
    const Estimate alone = estimate(scene, options);
    EXPECT_NEAR(many.mean, alone.mean,
                test_support::normal_threshold(test_support::per_test(3)) *
                    std::sqrt(many.variance + alone.variance));
    EXPECT_NEAR(many.variance, alone.variance, 0.2 * alone.variance);
  }
}

TEST_F(LightCandidates, MakeLessNoiseWhereLightsAreMany) {
  Scene scene = under_lamps(8, {16, 12});
  scene.camera.position = {0, 0.9, 0};  // below the lamps, where it sees nothing but the floor
  scene.camera.direction = glm::normalize(glm::dvec3(0, -1, -0.2));
  const double of_one = estimate(scene, options_for(1, 128)).variance;
  EXPECT_LT(estimate(scene, options_for(2, 128)).variance, 0.8 * of_one);
  EXPECT_LT(estimate(scene, options_for(8, 128)).variance, 0.5 * of_one);
}

constexpr Traversal kTraversals[] = {Traversal::brute_force,   Traversal::temporary_bin,   Traversal::refill,
                                     Traversal::lock_step,     Traversal::shared_treelets, Traversal::packets,
                                     Traversal::large_packets, Traversal::ray_streams};

TEST_F(LightCandidates, MakeTheSameImageForEveryTraversalDepthOfBufferingAndWidth) {
  for (const Scene& scene : {under_lamps(4, {12, 8}), under_every_kind({12, 8})}) {
    const std::string expected = testbench::render_natively(scene, options_for(4, 4)).film.sha256();
    EXPECT_NE(expected, testbench::render_natively(scene, options_for(1, 4)).film.sha256());
    for (const Traversal traversal : kTraversals)
      for (const int n : {0, 1, 3}) {
        RenderOptions options = options_for(4, 4);
        options.program.traversal = traversal;
        options.program.n = n;
        options.chip.chip.pes = n == 1 ? 16 : 96;
        EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), expected)
            << "traversal " << int(traversal) << ", n " << n;
      }
  }
}

TEST_F(LightCandidates, MakeTheSameImageOnTheChipWithoutHazards) {
  const Scene scene = under_every_kind({8, 6});
  for (const Shading shading : {Shading::present_lobes, Shading::material_bins})
    for (const Traversal traversal : {Traversal::brute_force, Traversal::refill})
      for (const int n : {0, 2}) {
        RenderOptions options = options_for(8, 4);
        options.program.shading = shading;
        options.program.traversal = traversal;
        options.program.n = n;
        const std::string expected = testbench::render_natively(scene, options_for(8, 4)).film.sha256();
        options.check_hazards = true;
        new_context();
        EXPECT_EQ(testbench::render_on_chip(scene, options).film.sha256(), expected)
            << "shading " << int(shading) << ", traversal " << int(traversal) << ", n " << n;
      }
}

/// A PE keeps, for each of two loads in flight, 48 bytes for a candidate and 16 for the choice.
TEST_F(LightCandidates, TakeRoomForTheirRecords) {
  const Scene scene = under_lamps(2, {8, 6});
  const auto peak_bytes = [&](int candidates) {
    new_context();
    return testbench::render_on_chip(scene, options_for(candidates, 1)).chip->poly_sram.peak_bytes;
  };
  const int of_two = peak_bytes(2);
  EXPECT_EQ(of_two - peak_bytes(1), 2 * (16 + 2 * 48));
  EXPECT_EQ(peak_bytes(8) - of_two, 2 * 6 * 48);
}

TEST_F(LightCandidates, AreChosenByTheNumberOfLights) {
  EXPECT_EQ(testbench::suited_light_candidates(
                test_support::plane_under_light({{0.25, 0.5, 0.75}, {4.0, 2.0, 1.0}}, {8, 6})),
            1);
  EXPECT_EQ(testbench::suited_light_candidates(under_lamps(2, {8, 6})), 8);
}

/// Under a sky, hits share the light of diffuse surfaces too; not where eight candidates agree on a light.
TEST_F(LightCandidates, DecideUnderASkyWhichEstimatorPays) {
  using path_tracer::Estimator;
  Scene scene = test_support::plane_under_light({{0.25, 0.5, 0.75}, {4.0, 2.0, 1.0}}, {8, 6});
  EXPECT_EQ(testbench::suited_estimator(scene, 1), Estimator::per_lobe);
  scene.environment.constant = glm::dvec3(1.0);
  EXPECT_EQ(testbench::suited_estimator(scene, 1), Estimator::per_lobe);  // which shadow rays do not aim at
  testbench::RadianceImage sky{4, 2, std::vector<float>(24, 1.0f)};
  sky.rgb[0] = 8.0f;
  scene.environment.image = sky;
  EXPECT_EQ(testbench::suited_estimator(scene, 1), Estimator::mis);
  EXPECT_EQ(testbench::suited_estimator(scene, 8), Estimator::per_lobe);
}

/// What the choice rests on: with equal samples, the variance of diffuse surfaces under a sky that is bright
/// at the zenith is lower, and the mean is the same.
TEST_F(LightCandidates, OfASkyAloneGainByHits) {
  Scene scene = test_support::sphere_under_light(3, {8, 6});
  for (testbench::Material& material : scene.materials) material.emission = glm::dvec3(0.0);
  testbench::RadianceImage sky{16, 8, std::vector<float>(384, 0.1f)};
  for (std::size_t i = 0; i < 192; ++i) sky.rgb[i] = 4.0f - float(i / 48);  // the upper half, row by row
  scene.environment.image = sky;
  const auto render_by = [&](path_tracer::Estimator estimator) {
    RenderOptions options = options_for(1, 256);
    options.program.estimator = estimator;
    options.program.sampler = path_tracer::Sampler::philox;
    return testbench::render_natively(scene, options).film;
  };
  const testbench::Film both = render_by(path_tracer::Estimator::mis);
  const testbench::Film shadow_rays = render_by(path_tracer::Estimator::per_lobe);
  double variance_of_both = 0.0;
  double variance = 0.0;
  double difference = 0.0;
  for (int pixel = 0; pixel < both.pixel_count(); ++pixel) {
    variance_of_both += both.variance_of_mean(pixel).x;
    variance += shadow_rays.variance_of_mean(pixel).x;
    difference += both.mean(pixel).x - shadow_rays.mean(pixel).x;
  }
  EXPECT_LT(variance_of_both, 0.8 * variance);
  EXPECT_LT(std::abs(difference), 5.0 * std::sqrt(variance + variance_of_both));
}

}  // namespace light_candidates_test
