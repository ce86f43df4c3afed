// Points, spots, parallel light and suns above a small diffuse square, against closed forms: its radiance is
// (reflectance / pi) * irradiance.

#include <gtest/gtest.h>

#include <cmath>

#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/statistics.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace lights_without_area_test {

using path_tracer::Estimator;
using path_tracer::Program;
using test_support::render_options;
using testbench::Light;
using testbench::LightKind;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

constexpr double kPi = 3.14159265358979323846;
const glm::dvec3 kReflectance{0.25, 0.5, 0.75};
const glm::dvec3 kIntensity{4.0, 2.0, 1.0};

void add_square(Scene& scene, const glm::dvec3& corner, const glm::dvec3& edge1, const glm::dvec3& edge2,
                std::int32_t material) {
  scene.triangles.push_back({{corner, corner + edge1, corner + edge1 + edge2}, material});
  scene.triangles.push_back({{corner, corner + edge1 + edge2, corner + edge2}, material});
}

/// The plane y = 0 around the origin, seen from above in a film of one pixel so small that all its rays hit
/// the origin.
Scene lit_by(const Light& light) {
  Scene scene;
  scene.name = "lit";
  scene.film = {1, 1};
  scene.camera.position = {0, 0.5, 0};
  scene.camera.direction = {0, -1, 0};
  scene.camera.up = {0, 0, 1};
  scene.camera.orthographic_height = 1e-9;
  scene.materials = {{"grey", kReflectance, glm::dvec3(0.0)}, {"black", glm::dvec3(0.0), glm::dvec3(0.0)}};
  add_square(scene, {-1, 0, -1}, {0, 0, 2}, {2, 0, 0}, 0);
  scene.lights = {light};
  return scene;
}

/// A black lid above the camera.
void add_cover(Scene& scene, double height) {
  add_square(scene, {-9, height, -9}, {0, 0, 18}, {18, 0, 0}, 1);
}

RenderResult render(const Scene& scene, int samples, Estimator estimator = Estimator::per_lobe) {
  RenderOptions options = render_options(Program::full, samples);
  options.program.estimator = estimator;
  return testbench::render_natively(scene, options);
}

void expect_radiance(const Scene& scene, const glm::dvec3& irradiance) {
  for (const Estimator estimator : {Estimator::light, Estimator::mis, Estimator::per_lobe}) {
    const glm::dvec3 mean = render(scene, 2, estimator).film.mean(0);
    const glm::dvec3 expected = kReflectance / kPi * irradiance;
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(mean[channel], expected[channel], 1e-7 * expected[channel]) << channel;
  }
}

Light point_at(const glm::dvec3& position) {
  Light light;
  light.kind = LightKind::point;
  light.position = position;
  light.intensity = kIntensity;
  return light;
}

TEST(LightsWithoutArea, PointFallsOffWithCosineAndSquaredDistance) {
  for (const glm::dvec3& position : {glm::dvec3(0, 2, 0), glm::dvec3(3, 1, -2), glm::dvec3(-1, 7, 4)}) {
    const double distance = glm::length(position);
    expect_radiance(lit_by(point_at(position)), kIntensity * (position.y / distance / (distance * distance)));
  }
  expect_radiance(lit_by(point_at({1, -2, 0})), glm::dvec3(0.0));
}

TEST(LightsWithoutArea, OnlyWhatIsBetweenHidesAPoint) {
  Scene scene = lit_by(point_at({0, 2, 0}));
  add_cover(scene, 3.0);
  expect_radiance(scene, kIntensity / 4.0);
  add_cover(scene, 1.0);
  expect_radiance(scene, glm::dvec3(0.0));
}

TEST(LightsWithoutArea, SpotIsBrightWithinItsInnerConeAndDarkBeyondItsOuterOne) {
  const glm::dvec3 position(1, 2, 2);  // three from the origin
  const glm::dvec3 to_origin = -position / 3.0;
  const glm::dvec3 aside = glm::normalize(glm::cross(to_origin, glm::dvec3(0, 1, 0)));
  const double inner = 0.3;
  const double outer = 0.5;
  const double full = position.y / 27.0;
  const auto share = [&](double angle) {
    const double linear = (std::cos(angle) - std::cos(outer)) / (std::cos(inner) - std::cos(outer));
    return angle <= inner ? 1.0 : angle >= outer ? 0.0 : linear * linear;
  };
  for (const double angle : {0.0, 0.2, 0.29, 0.31, 0.4, 0.49, 0.51, 2.0}) {
    Light spot = point_at(position);
    spot.kind = LightKind::spot;
    spot.direction = std::cos(angle) * to_origin + std::sin(angle) * aside;
    spot.inner_cone_radians = inner;
    spot.outer_cone_radians = outer;
    expect_radiance(lit_by(spot), kIntensity * (full * share(angle)));
  }
}

Light from_sky(LightKind kind, double zenith_angle, double diameter_radians = 0.0) {
  Light light;
  light.kind = kind;
  light.direction = {-std::sin(zenith_angle), -std::cos(zenith_angle), 0.0};
  light.intensity = kIntensity;
  light.angular_diameter_radians = diameter_radians;
  return light;
}

TEST(LightsWithoutArea, ParallelLightFallsOffWithCosine) {
  for (const double angle : {0.0, 0.5, 1.5})
    expect_radiance(lit_by(from_sky(LightKind::directional, angle)), kIntensity * std::cos(angle));
  expect_radiance(lit_by(from_sky(LightKind::directional, 2.0)), glm::dvec3(0.0));
  Scene covered = lit_by(from_sky(LightKind::directional, 0.5));
  add_cover(covered, 10.0);
  expect_radiance(covered, glm::dvec3(0.0));
}

/// @param irradiance of the horizontal plane
void expect_mean(const Scene& scene, const glm::dvec3& irradiance) {
  const testbench::Film film = render(scene, 16384).film;
  const glm::dvec3 expected = kReflectance / kPi * irradiance;
  const double threshold = test_support::normal_threshold(test_support::per_test(9));
  for (int channel = 0; channel < 3; ++channel) {
    const double deviation = std::sqrt(film.variance_of_mean(0)[channel]) + 1e-12 * expected[channel];
    EXPECT_NEAR(film.mean(0)[channel], expected[channel], threshold * deviation) << channel;
  }
}

TEST(LightsWithoutArea, SunAboveTheHorizonGivesWhatParallelLightGives) {
  const double half_a_degree = kPi / 360.0;
  expect_mean(lit_by(from_sky(LightKind::sun, 1.0, half_a_degree)), kIntensity * std::cos(1.0));
  const double quarter_turn = kPi / 2.0;
  expect_mean(lit_by(from_sky(LightKind::sun, 0.6, quarter_turn)), kIntensity * std::cos(0.6));
}

/// A disk of half angle 30 degrees whose middle is at the cosine 0.2 to the zenith lies partly below the
/// horizon: E / (pi L) = 0.0593458 (Lagarde, de Rousiers, "Moving Frostbite to PBR", SIGGRAPH 2014 course,
/// the sphere light; here by a numerical integral as well).
TEST(LightsWithoutArea, SunAcrossTheHorizonGivesItsVisiblePart) {
  constexpr double kSine = 0.5;
  constexpr double kCosine = 0.2;
  const double x = std::sqrt(1 / (kSine * kSine) - 1);
  const double sine_of_zenith = std::sqrt(1 - kCosine * kCosine);
  const double y = -x * kCosine / sine_of_zenith;
  const double across = sine_of_zenith * std::sqrt(1 - y * y);
  const double e_by_l = kSine * kSine * (kCosine * std::acos(y) - x * across) + std::atan(across / x);
  EXPECT_NEAR(e_by_l / kPi, 0.0593458, 1e-7);
  const glm::dvec3 radiance = kIntensity / (kPi * kSine * kSine);
  expect_mean(lit_by(from_sky(LightKind::sun, std::acos(kCosine), kPi / 3.0)), radiance * e_by_l);
}

/// A ray that leaves the scene sees the sun's disk, and nothing of parallel light.
TEST(LightsWithoutArea, TheCameraSeesTheSunsDisk) {
  const double diameter = 0.02;
  Scene scene = lit_by(from_sky(LightKind::sun, 0.0, diameter));
  const glm::dvec3 radiance = kIntensity / (kPi * std::sin(0.01) * std::sin(0.01));
  for (const double angle : {0.0, 0.0099, 0.0101}) {
    scene.camera.direction = {std::sin(angle), std::cos(angle), 0.0};
    scene.camera.up = {std::cos(angle), -std::sin(angle), 0.0};
    for (const Program program : {Program::segments, Program::full}) {
      const glm::dvec3 seen = testbench::render_natively(scene, render_options(program, 1)).film.mean(0);
      EXPECT_NEAR(seen.x, angle < 0.01 ? radiance.x : 0.0, 1e-9 * radiance.x) << angle;
    }
  }
}

class LightsWithoutAreaOnChip : public test_support::SystemCFixture {};

/// Results do not depend on how the hits of shadow rays are searched for.
TEST_F(LightsWithoutAreaOnChip, AllTraversalsGiveOneImage) {
  Scene scene = test_support::sphere_under_light(8, {12, 8});
  scene.lights = {point_at({0.3, 1.2, 0.1}), from_sky(LightKind::sun, 0.7, 0.1)};
  RenderOptions options = render_options(Program::full, 4);
  const RenderResult expected = testbench::render_natively(scene, options);
  for (const auto traversal : {path_tracer::Traversal::temporary_bin, path_tracer::Traversal::refill,
                               path_tracer::Traversal::packets, path_tracer::Traversal::shared_treelets}) {
    options.program.traversal = traversal;
    EXPECT_EQ(testbench::render_natively(scene, options).film.rgb(), expected.film.rgb());
  }
  options.program.traversal = path_tracer::Traversal::refill;
  new_context();
  options.check_hazards = true;
  EXPECT_EQ(testbench::render_on_chip(scene, options).film.rgb(), expected.film.rgb());
}

}  // namespace lights_without_area_test
