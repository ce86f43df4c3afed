// Renders of scenes in which surfaces coincide, against scenes that look the same without.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "testbench/run/render.hpp"
#include "testbench/scene/coincident_triangles.hpp"
#include "tests/support/native_paths.hpp"

namespace layers_render_test {

using path_tracer::LightSampling;
using path_tracer::Program;
using path_tracer::Traversal;
using testbench::Film;
using testbench::RenderOptions;
using testbench::Scene;
using testbench::Triangle;

enum : std::int32_t { kWall, kLamp, kBrightLamp };

/// Part of a horizontal plane.
struct Rectangle {
  double x0, y0, x1, y1, z;
  bool faces_up;
  std::int32_t material = kWall;
  bool has_other_diagonal = false;
};

std::vector<Triangle> triangles_of(const std::vector<Rectangle>& rectangles) {
  std::vector<Triangle> triangles;
  for (const Rectangle& r : rectangles) {
    glm::dvec3 corner[4] = {{r.x0, r.y0, r.z}, {r.x1, r.y0, r.z}, {r.x1, r.y1, r.z}, {r.x0, r.y1, r.z}};
    if (!r.faces_up) std::swap(corner[1], corner[3]);
    const int first = r.has_other_diagonal ? 1 : 0;
    const auto at = [&](int i) { return corner[(first + i) % 4]; };
    triangles.push_back({{at(0), at(1), at(2)}, r.material});
    triangles.push_back({{at(0), at(2), at(3)}, r.material});
  }
  return triangles;
}

/// Where a scene stands.
struct Placement {
  unsigned turn;
  double scale;
  double shift;
};
constexpr Placement kPlacements[] = {{0, 1, 0},     {1, 1, 0},   {2, 1e20, 0},
                                     {3, 1e-12, 0}, {4, 1, 1e6}, {0, 1, 1e7}};

Scene room(const std::vector<Rectangle>& rectangles, const Placement& place, const glm::dvec3& camera,
           const glm::dvec3& look_at) {
  std::mt19937_64 random(place.turn);
  std::normal_distribution<double> number;
  const auto any = [&] { return glm::normalize(glm::dvec3(number(random), number(random), number(random))); };
  const glm::dvec3 u = place.turn == 0 ? glm::dvec3(1, 0, 0) : any();
  const glm::dvec3 v = place.turn == 0 ? glm::dvec3(0, 1, 0) : glm::normalize(glm::cross(u, any()));
  const glm::dvec3 w = glm::cross(u, v);
  const auto turned = [&](const glm::dvec3& p) { return u * p.x + v * p.y + w * p.z; };
  const auto placed = [&](const glm::dvec3& p) {
    return turned(p) * place.scale + glm::dvec3(0.6, -1, 0.3) * place.shift;
  };
  Scene scene;
  scene.name = "room";
  scene.film = {12, 12};
  scene.materials = {{"wall", glm::dvec3(0.5), glm::dvec3(0.0)},
                     {"lamp", glm::dvec3(0.0), glm::dvec3(1.0)},
                     {"bright lamp", glm::dvec3(0.0), glm::dvec3(3.0)}};
  scene.triangles = triangles_of(rectangles);
  for (Triangle& triangle : scene.triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex = placed(vertex);
  scene.camera.position = placed(camera);
  scene.camera.direction = glm::normalize(turned(look_at - camera));
  const glm::dvec3 up = turned({0.1, 1, 0.2});
  scene.camera.up = glm::normalize(up - scene.camera.direction * glm::dot(scene.camera.direction, up));
  scene.camera.vertical_field_of_view_radians = 1.0;
  testbench::order_coincident_triangles(scene, scene.name);
  return scene;
}

RenderOptions options_for(Program program, LightSampling sampling, int samples) {
  RenderOptions options = test_support::render_options(program, samples);
  options.program.light_sampling = sampling;
  return options;
}

Film render(const Scene& scene, const RenderOptions& options) {
  return testbench::render_natively(scene, options).film;
}

struct Mean {
  double value = 0;
  double variance = 0;
};
Mean mean_of(const Film& film) {
  Mean mean;
  const int pixels = film.pixel_count();
  for (int pixel = 0; pixel < pixels; ++pixel) {
    mean.value += film.mean(pixel).x / pixels;
    mean.variance += film.variance_of_mean(pixel).x / pixels / pixels;
  }
  return mean;
}

void expect_equal_means(const Film& found, const Film& expected) {
  const Mean a = mean_of(found);
  const Mean b = mean_of(expected);
  EXPECT_GT(b.value, 0.001);
  EXPECT_LT(std::abs(a.value - b.value), 4.5 * std::sqrt(a.variance + b.variance))
      << a.value << " " << b.value;
}

const Rectangle kFloor{-3, -3, 3, 3, 0, true};
const Rectangle kCeiling{-3, -3, 3, 3, 3, false};
const Rectangle kCeilingLamp{-1, -1, 1, 1, 3, false, kLamp};
const Rectangle kSky{-2, -2, 2, 2, 6, false, kBrightLamp};
/// The ceiling around the lamp.
const std::vector<Rectangle> kHoledCeiling{
    {-3, -3, 3, -1, 3, false}, {-3, 1, 3, 3, 3, false}, {-3, -1, -1, 1, 3, false}, {1, -1, 3, 1, 3, false}};
const glm::dvec3 kInside(0, 0, 2.5);
const glm::dvec3 kOutside(3.5, -4, 3.5);
const glm::dvec3 kOnFloor(0.3, 0.2, 0);

std::vector<Rectangle> with(std::vector<Rectangle> rectangles, const std::vector<Rectangle>& others) {
  rectangles.insert(rectangles.end(), others.begin(), others.end());
  return rectangles;
}

/// A sheet of the same reflectance on another one, either side up and cut either way, changes no path but by
/// rounding: that once made it 24 % darker.
TEST(LayersRender, ASecondSheetChangesNothing) {
  const std::vector<Rectangle> base{kFloor, {-2, -2, 2, 2, 1.5, true}, kSky};
  const Rectangle carpets[] = {{-1, -2, 2.5, 1, 0, true},
                               {-2, -2, 2, 2, 1.5, false},
                               {-2, -2, 2, 2, 1.5, false, kWall, true},
                               {-2, -2, 2, 2, 1.5, true, kWall, true}};
  for (const Placement& place : kPlacements) {
    const RenderOptions options = options_for(Program::full, LightSampling::solid_angle, 16);
    const Film expected = render(room(base, place, kOutside, kOnFloor), options);
    for (const Rectangle& carpet : carpets) {
      const Scene scene = room(with(base, {carpet}), place, kOutside, kOnFloor);
      ASSERT_GT(scene.coincident_triangles, 0u);
      const Film found = render(scene, options);
      double difference = 0;
      for (int pixel = 0; pixel < found.pixel_count(); ++pixel)
        difference += std::abs(found.mean(pixel).x - expected.mean(pixel).x);
      EXPECT_LT(difference, 1e-3 * mean_of(expected).value * found.pixel_count())
          << place.turn << " " << place.scale << " " << place.shift;
    }
  }
}

TEST(LayersRender, ALampInACeilingsPlaneLightsAsInAHole) {
  for (const Placement& place : kPlacements)
    for (const bool is_named_first : {true, false})
      for (const LightSampling sampling : {LightSampling::area, LightSampling::solid_angle}) {
        const std::vector<Rectangle> rectangles =
            is_named_first ? std::vector<Rectangle>{kCeilingLamp, kFloor, kCeiling}
                           : std::vector<Rectangle>{kFloor, kCeiling, kCeilingLamp};
        const Scene scene = room(rectangles, place, kInside, kOnFloor);
        ASSERT_EQ(scene.coincident_triangles, 4u);
        const Scene holed = room(with({kFloor, kCeilingLamp}, kHoledCeiling), place, kInside, kOnFloor);
        ASSERT_EQ(holed.coincident_triangles, 0u);
        RenderOptions options = options_for(Program::full, sampling, 64);
        const Film found = render(scene, options);
        options.program.seed = 2;
        expect_equal_means(found, render(holed, options));
      }
}

/// Back to back, each is seen from its own side: the lamp lights what is above it, the wall below is dark.
TEST(LayersRender, ALampOnAWallsBackLightsItsOwnSideOnly) {
  for (const Placement& place : kPlacements) {
    const std::vector<Rectangle> rectangles{
        kFloor, kCeiling, {-1, -1, 1, 1, 1.5, false}, {-1, -1, 1, 1, 1.5, true, kLamp}};
    std::vector<Rectangle> apart = rectangles;
    apart.back().z = 1.5001;
    RenderOptions options = options_for(Program::full, LightSampling::solid_angle, 64);
    const Scene scene = room(rectangles, place, kOutside, {0, 0, 1.5});
    ASSERT_GE(scene.coincident_triangles, 2u);
    const Film found = render(scene, options);
    options.program.seed = 2;
    expect_equal_means(found, render(room(apart, place, kOutside, {0, 0, 1.5}), options));
  }
}

/// Part of a lamp that another one covers is not seen and must not light either.
TEST(LayersRender, LampsThatOverlapLightOnceInEveryProgram) {
  const Rectangle second{0, -0.5, 2, 2, 3, false, kBrightLamp};
  const std::vector<Rectangle> rest{{1, -0.5, 2, 1, 3, false, kBrightLamp},
                                    {0, 1, 2, 2, 3, false, kBrightLamp}};
  for (const Placement& place : {kPlacements[1], kPlacements[4]}) {
    const Scene scene = room({kFloor, kCeilingLamp, second}, place, kInside, kOnFloor);
    const Scene cut = room(with({kFloor, kCeilingLamp}, rest), place, kInside, kOnFloor);
    ASSERT_GT(scene.coincident_triangles, 0u);
    ASSERT_EQ(cut.coincident_triangles, 0u);
    for (const LightSampling sampling : {LightSampling::area, LightSampling::solid_angle}) {
      RenderOptions full = options_for(Program::full, sampling, 256);
      full.program.sampler = path_tracer::Sampler::philox;
      const Film found = render(scene, full);
      RenderOptions segments = options_for(Program::segments, sampling, 4096);
      segments.program.sampler = path_tracer::Sampler::philox;
      expect_equal_means(render(scene, segments), found);
      full.program.seed = 2;
      expect_equal_means(found, render(cut, full));
    }
  }
}

/// Every way to the hits gives the same bits.
TEST(LayersRender, IsTheSameForEveryTraversalAndBuffering) {
  const std::vector<Rectangle> rectangles{kFloor,
                                          kCeiling,
                                          kCeilingLamp,
                                          {0, -0.5, 2, 2, 3, false, kBrightLamp},
                                          {-1, -2, 2.5, 1, 0, true},
                                          {-1, -1, 1, 1, 1.5, false},
                                          {-1, -1, 1, 1, 1.5, true, kLamp}};
  for (const Placement& place : {kPlacements[0], kPlacements[1], kPlacements[4]}) {
    const Scene scene = room(rectangles, place, kInside, kOnFloor);
    for (const Program program : {Program::segments, Program::full}) {
      RenderOptions options = options_for(program, LightSampling::solid_angle, 4);
      options.chip.poly.sram_bytes = 32768;  // n = 8 needs more than the CSX600's 6 KiB
      const std::string expected = render(scene, options).sha256();
      for (const Traversal traversal :
           {Traversal::brute_force, Traversal::temporary_bin, Traversal::refill, Traversal::lock_step,
            Traversal::packets, Traversal::shared_treelets, Traversal::large_packets, Traversal::ray_streams})
        for (const int n : {0, 1, 8}) {
          options.program.traversal = traversal;
          options.program.n = n;
          EXPECT_EQ(render(scene, options).sha256(), expected) << int(traversal) << " " << n;
        }
    }
  }
}

}  // namespace layers_render_test
