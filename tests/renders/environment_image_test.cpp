// Environments with an image, against closed forms and against environments of one colour.

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "testbench/run/render.hpp"
#include "tests/support/input_error.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/statistics.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace environment_image_test {

using path_tracer::Estimator;
using path_tracer::Program;
using test_support::render_options;
using testbench::Film;
using testbench::RadianceImage;
using testbench::RenderOptions;
using testbench::Scene;

constexpr double kPi = 3.14159265358979323846;
constexpr double kReflectance = 0.5;

RadianceImage black_image(int width, int height) {
  return {width, height, std::vector<float>(std::size_t(3 * width * height), 0.0f)};
}

RadianceImage random_image(int width, int height) {
  RadianceImage image = black_image(width, height);
  std::mt19937 random(7);
  for (float& channel : image.rgb) channel = std::ldexp(float(random() >> 8), -20);
  return image;
}

/// A square that faces up, seen from above in one small pixel.
Scene under(const RadianceImage& image) {
  Scene scene;
  scene.name = "under";
  scene.film = {1, 1};
  scene.camera.position = {0, 0.5, 0};
  scene.camera.direction = {0, -1, 0};
  scene.camera.up = {0, 0, 1};
  scene.camera.orthographic_height = 1e-9;
  scene.materials = {{"grey", glm::dvec3(kReflectance), glm::dvec3(0.0)}};
  scene.triangles = {{{{-1, 0, -1}, {-1, 0, 1}, {1, 0, 1}}, 0}, {{{-1, 0, -1}, {1, 0, 1}, {1, 0, -1}}, 0}};
  scene.environment.image = image;
  return scene;
}

Film render(const Scene& scene, int samples, Estimator estimator, Program program = Program::full) {
  RenderOptions options = render_options(program, samples);
  options.program.estimator = estimator;
  return testbench::render_natively(scene, options).film;
}

void expect_mean(const Film& film, double expected, double tests) {
  const double threshold = test_support::normal_threshold(test_support::per_test(tests));
  const double deviation = std::sqrt(film.variance_of_mean(0).x) + 1e-6 * expected;
  EXPECT_NEAR(film.mean(0).x, expected, threshold * deviation);
}

constexpr Estimator kEstimators[] = {Estimator::light, Estimator::mis, Estimator::per_lobe};

TEST(EnvironmentImage, OneColourGivesWhatAnEnvironmentOfThatColourGives) {
  RadianceImage image = black_image(8, 4);
  for (float& channel : image.rgb) channel = 3.0f;
  for (const Estimator estimator : kEstimators)
    expect_mean(render(under(image), 16384, estimator), 3.0 * kReflectance, 3);
}

/// A texel between the colatitudes a and b, w wide, gives the irradiance L w (sin^2 b - sin^2 a) / 2.
TEST(EnvironmentImage, OneBrightTexelGivesItsIrradiance) {
  RadianceImage image = black_image(16, 8);
  const int column = 5;
  const int row = 2;
  image.rgb[std::size_t(3 * (row * 16 + column))] = 100.0f;
  const double a = kPi * row / 8;
  const double b = kPi * (row + 1) / 8;
  const double width = 2 * kPi / 16;
  const double sine_a = std::sin(a);
  const double sine_b = std::sin(b);
  const double irradiance = 100.0 * width * 0.5 * (sine_b * sine_b - sine_a * sine_a);
  for (const Estimator estimator : kEstimators) {
    Scene scene = under(image);
    const Film film = render(scene, 16384, estimator);
    expect_mean(film, kReflectance / kPi * irradiance, 6);
    EXPECT_EQ(film.mean(0).y, 0.0);
    scene.environment.scale = 0.25;
    expect_mean(render(scene, 16384, estimator), kReflectance / kPi * irradiance / 4, 6);
  }
}

/// Directions of rays and texels belong together, whatever the rotation: a ray that leaves the scene sees
/// environment_radiance().
TEST(EnvironmentImage, RaysThatLeaveSeeTheirTexel) {
  Scene scene = under(random_image(32, 16));
  scene.environment.scale = 0.5;
  const double angle = 0.7;
  scene.environment.rotation = glm::dmat3(std::cos(angle), std::sin(angle), 0.0, -std::sin(angle),
                                          std::cos(angle), 0.0, 0.0, 0.0, 1.0);
  scene.environment.rotation = scene.environment.rotation * glm::dmat3(1, 0, 0, 0, 0.6, 0.8, 0, -0.8, 0.6);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 direction =
        glm::normalize(glm::dvec3(normal(random), std::abs(normal(random)), normal(random)));
    scene.camera.direction = direction;
    scene.camera.up = glm::normalize(glm::cross(direction, glm::dvec3(0.3, 0.1, 0.9)));
    const glm::dvec3 expected = testbench::environment_radiance(scene.environment, direction);
    for (const Program program : {Program::segments, Program::full}) {
      const glm::dvec3 seen = render(scene, 1, Estimator::per_lobe, program).mean(0);
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(seen[channel], expected[channel], 1e-6 * expected[channel]) << i;
    }
  }
}

/// Shadow rays, hits and both have one mean, on diffuse and on glossy surfaces, with a lamp in the scene.
TEST(EnvironmentImage, EstimatorsAgree) {
  Scene scene = test_support::sphere_under_light(6, {6, 4});
  scene.environment.image = random_image(12, 6);
  scene.environment.rotation = glm::dmat3(0, 0, -1, 0, 1, 0, 1, 0, 0);
  for (const double roughness : {1.0, 0.3}) {
    for (testbench::Material& material : scene.materials) {
      material.specular = roughness < 1.0 ? 1.0 : 0.0;
      material.roughness = roughness;
    }
    const Film by_hits = render(scene, 4096, Estimator::per_lobe, Program::segments);
    const double threshold =
        test_support::normal_threshold(test_support::per_test(6.0 * by_hits.pixel_count()));
    for (const Estimator estimator : kEstimators) {
      const Film film = render(scene, 1024, estimator);
      for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
        const double variance = film.variance_of_mean(pixel).x + by_hits.variance_of_mean(pixel).x;
        EXPECT_NEAR(film.mean(pixel).x, by_hits.mean(pixel).x, threshold * std::sqrt(variance) + 1e-9)
            << pixel << ", roughness " << roughness << ", estimator " << int(estimator);
      }
    }
  }
}

class EnvironmentImageOnChip : public test_support::SystemCFixture {};

TEST_F(EnvironmentImageOnChip, ChipAndTraversalsGiveOneImage) {
  Scene scene = test_support::sphere_under_light(6, {12, 8});
  scene.environment.image = random_image(64, 32);
  RenderOptions options = render_options(Program::full, 4);
  options.program.estimator = Estimator::mis;
  const auto expected = testbench::render_natively(scene, options).film.rgb();
  for (const auto traversal : {path_tracer::Traversal::brute_force, path_tracer::Traversal::temporary_bin,
                               path_tracer::Traversal::refill, path_tracer::Traversal::packets,
                               path_tracer::Traversal::shared_treelets}) {
    options.program.traversal = traversal;
    for (const int n : {0, 1}) {
      options.program.n = n;
      EXPECT_EQ(testbench::render_natively(scene, options).film.rgb(), expected);
      new_context();
      options.check_hazards = true;
      EXPECT_EQ(testbench::render_on_chip(scene, options).film.rgb(), expected);
    }
  }
}

TEST(EnvironmentImage, ABlackOneAloneIsRefused) {
  const Scene scene = under(black_image(4, 2));
  const std::string message = test_support::input_error_of([&] { render(scene, 1, Estimator::per_lobe); });
  EXPECT_NE(message.find("image is black"), std::string::npos) << message;
  Scene bright = under(random_image(4, 2));
  bright.environment.image->rgb[0] = 3e38f;
  bright.environment.scale = 100.0;
  EXPECT_NE(
      test_support::input_error_of([&] { render(bright, 1, Estimator::per_lobe); }).find("environment.scale"),
      std::string::npos);
}

}  // namespace environment_image_test
