// Means of whole images against closed forms, to 0.1 %: the standard error is below that, and the mean lies
// within four of them. Random numbers are independent, so that films know their own variance.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"

namespace closed_forms_test {

using path_tracer::Estimator;
using path_tracer::Program;
using testbench::FilmSize;
using testbench::Material;
using testbench::RenderOptions;
using testbench::Scene;

constexpr double kPi = 3.14159265358979323846;

/// How light is found.
enum class Way { hits, light, mis };
constexpr std::array kNames = {"hits", "shadow rays", "both"};

RenderOptions options_of(Way way, int samples) {
  RenderOptions options =
      test_support::render_options(way == Way::hits ? Program::segments : Program::full, samples);
  options.program.sampler = path_tracer::Sampler::philox;
  options.program.light_sampling = path_tracer::LightSampling::solid_angle;
  options.program.estimator = way == Way::mis ? Estimator::mis : Estimator::light;
  options.program.roulette_start = 3;
  return options;
}

void expect_mean(const Scene& scene, Way way, int samples, double expected) {
  const testbench::Film film = render_natively(scene, options_of(way, samples)).film;
  double mean = 0;
  double variance = 0;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    mean += film.mean(pixel).x / film.pixel_count();
    variance += film.variance_of_mean(pixel).x / (double(film.pixel_count()) * film.pixel_count());
  }
  const double error = std::sqrt(variance);
  EXPECT_LT(error, 1e-3 * expected) << kNames[std::size_t(way)] << ": too few samples to tell";
  EXPECT_LT(std::abs(mean - expected), 4 * error + 1e-12)
      << kNames[std::size_t(way)] << ": " << mean << ", expected is " << expected;
}

/// Counter-clockwise as seen from the front.
void add_square(Scene& scene, const std::array<glm::dvec3, 4>& corners, std::int32_t material) {
  scene.triangles.push_back({{corners[0], corners[1], corners[2]}, material});
  scene.triangles.push_back({{corners[0], corners[2], corners[3]}, material});
}

Material emitter(double radiance) {
  Material material;
  material.emission = glm::dvec3(radiance);
  return material;
}

Material diffuse(double reflectance) {
  Material material;
  material.reflectance = glm::dvec3(reflectance);
  return material;
}

/// An orthographic camera; up is any direction that is not the camera's.
Scene seen_along(const glm::dvec3& position, const glm::dvec3& direction, const glm::dvec3& up,
                 double height) {
  Scene scene;
  scene.name = "closed form";
  scene.film = {16, 16};
  scene.camera.position = position;
  scene.camera.direction = glm::normalize(direction);
  scene.camera.up = glm::normalize(up - glm::dot(up, scene.camera.direction) * scene.camera.direction);
  scene.camera.orthographic_height = height;
  return scene;
}

/// Everything emits 0.2 and reflects 0.8: 0.2 / (1 - 0.8).
TEST(ClosedForms, Furnace) {
  expect_mean(test_support::closed_cube(0.8, 0.2, {16, 16}), Way::hits, 4096, 1);
  for (const Way way : {Way::light, Way::mis})
    expect_mean(test_support::closed_sphere(0.8, 0.2, 1, {16, 16}), way, 2048, 1);
}

/// A unit square that reflects 0.5 and fills the film, and a light that leaves it out of sight.
Scene lit_square(const std::array<glm::dvec3, 4>& light) {
  Scene scene = seen_along({0.5, 0.5, 0.5}, {0, -1, 0}, {0, 0, 1}, 1);
  scene.materials = {diffuse(0.5), emitter(1)};
  add_square(scene, {{{0, 0, 0}, {0, 0, 1}, {1, 0, 1}, {1, 0, 0}}}, 0);
  add_square(scene, light, 1);
  return scene;
}

/// Two unit squares face each other at the distance 1 (Howell's catalogue of configuration factors, C-11).
TEST(ClosedForms, OpposedSquares) {
  const double factor =
      2 / kPi *
      (0.5 * std::log(4.0 / 3) + 2 * std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) - 2 * std::atan(1.0));
  EXPECT_NEAR(factor, 0.199824896, 1e-9);
  const Scene scene = lit_square({{{0, 1, 0}, {1, 1, 0}, {1, 1, 1}, {0, 1, 1}}});
  expect_mean(scene, Way::hits, 20000, 0.5 * factor);
  for (const Way way : {Way::light, Way::mis}) expect_mean(scene, way, 1024, 0.5 * factor);
}

/// Two unit squares with a common edge at a right angle (the same, C-14).
TEST(ClosedForms, SquaresAtARightAngle) {
  const double factor = 1 / kPi *
                        (2 * std::atan(1.0) - std::sqrt(2.0) * std::atan(1 / std::sqrt(2.0)) +
                         0.25 * std::log(4.0 / 3 * std::pow(3.0 / 4, 2)));
  EXPECT_NEAR(factor, 0.200043776, 1e-9);
  const Scene scene = lit_square({{{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}});
  for (const Way way : {Way::light, Way::mis}) expect_mean(scene, way, 5000, 0.5 * factor);
}

/// Adds an eighth of a sphere of triangles whose corners lie on it; the outside is the front. Returns their
/// form factor as seen from the origin with the normal +y: Lambert's sum over the edges of each that shows
/// its front.
double add_octant(Scene& scene, const glm::dvec3& centre, double radius,
                  const std::array<glm::dvec3, 3>& corner, int levels) {
  const auto [a, b, c] = corner;
  if (levels > 0) {
    const glm::dvec3 ab = glm::normalize(a + b);
    const glm::dvec3 bc = glm::normalize(b + c);
    const glm::dvec3 ca = glm::normalize(c + a);
    return add_octant(scene, centre, radius, {a, ab, ca}, levels - 1) +
           add_octant(scene, centre, radius, {ab, b, bc}, levels - 1) +
           add_octant(scene, centre, radius, {ca, bc, c}, levels - 1) +
           add_octant(scene, centre, radius, {ab, bc, ca}, levels - 1);
  }
  testbench::Triangle triangle{{centre + radius * a, centre + radius * b, centre + radius * c}, 1};
  const auto normal = [&] {
    return glm::cross(triangle.vertex[1] - triangle.vertex[0], triangle.vertex[2] - triangle.vertex[0]);
  };
  if (glm::dot(normal(), a) < 0) std::swap(triangle.vertex[1], triangle.vertex[2]);
  scene.triangles.push_back(triangle);
  if (glm::dot(normal(), -triangle.vertex[0]) <= 0) return 0;
  double sum = 0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 from = glm::normalize(triangle.vertex[i]);
    const glm::dvec3 to = glm::normalize(triangle.vertex[(i + 1) % 3]);
    sum += std::acos(glm::dot(from, to)) * glm::normalize(glm::cross(from, to)).y;
  }
  return std::abs(sum) / (2 * kPi);
}

/// A ball of light of radius 1 at the distance 2, 36.87 degrees from the normal: a quarter of the cosine,
/// 0.2, less what the triangles are smaller than the ball.
TEST(ClosedForms, BallOfLight) {
  Scene scene = seen_along({0, 1e-3, 0}, {0, -1, 0}, {0, 0, 1}, 1e-3);
  scene.materials = {diffuse(0.5), emitter(1)};
  add_square(scene, {{{-9, 0, -9}, {-9, 0, 9}, {9, 0, 9}, {9, 0, -9}}}, 0);
  double factor = 0;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0})
        factor += add_octant(scene, {1.2, 1.6, 0}, 1, {{{x, 0, 0}, {0, y, 0}, {0, 0, z}}}, 1);
  EXPECT_LT(factor, 0.2);
  EXPECT_GT(factor, 0.15);
  expect_mean(scene, Way::light, 30000, 0.5 * factor);
  expect_mean(scene, Way::mis, 12000, 0.5 * factor);
}

/// At normal incidence a slab of index 1.5 passes (1 - F) / (1 + F) of the light behind it, F = 0.04, after
/// any number of reflections within.
TEST(ClosedForms, Slab) {
  Scene scene = seen_along({0, 0, 10}, {0, 0, -1}, {0, 1, 0}, 0.1);
  Material glass = diffuse(1);
  glass.specular = 1;
  glass.roughness = 0;
  glass.transmission = 1;
  glass.is_thin = false;
  scene.materials = {glass, emitter(1)};
  add_square(scene, {{{-5, -5, 1}, {5, -5, 1}, {5, 5, 1}, {-5, 5, 1}}}, 0);
  add_square(scene, {{{-5, -5, 0}, {-5, 5, 0}, {5, 5, 0}, {5, -5, 0}}}, 0);
  add_square(scene, {{{-9, -9, -9}, {9, -9, -9}, {9, 9, -9}, {-9, 9, -9}}}, 1);
  for (const Way way : {Way::hits, Way::light, Way::mis}) expect_mean(scene, way, 1024, 0.96 / 1.04);
}

/// A ray crosses between two mirrors at 45 degrees and meets the light after five reflections of Schlick's F
/// each.
TEST(ClosedForms, CorridorOfMirrors) {
  Scene scene = seen_along({0, 0.5, 0}, {1, 1, 0}, {-1, 1, 0}, 0.2);
  Material mirror = diffuse(0.9);
  mirror.metallic = 1;
  mirror.specular = 1;
  mirror.roughness = 0;
  scene.materials = {mirror, emitter(1)};
  add_square(scene, {{{-1, 0, -5}, {-1, 0, 5}, {6, 0, 5}, {6, 0, -5}}}, 0);
  add_square(scene, {{{-1, 1, -5}, {6, 1, -5}, {6, 1, 5}, {-1, 1, 5}}}, 0);
  add_square(scene, {{{5, 0, -5}, {5, 0, 5}, {5, 1, 5}, {5, 1, -5}}}, 1);
  const double reflectance = 0.9 + 0.1 * std::pow(1 - std::sqrt(0.5), 5);
  for (const Way way : {Way::hits, Way::light, Way::mis})
    expect_mean(scene, way, 2048, std::pow(reflectance, 5));
}

}  // namespace closed_forms_test
