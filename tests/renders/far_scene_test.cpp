// A scene far from the origin is rendered as it is at the origin, to the bit and to the cycle.

#include <cmath>

#include "testbench/mono_image/mono_image.hpp"
#include "testbench/run/render.hpp"
#include "testbench/scene/normalise.hpp"
#include "testbench/scene/triangle_bounds.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace far_scene_test {

using path_tracer::NodeFormat;
using path_tracer::Program;
using path_tracer::Traversal;
using test_support::render_options;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

class FarScene : public test_support::SystemCFixture {};

template <class Move>
void move_places(Scene& scene, Move&& move) {
  scene.camera.position = move(scene.camera.position);
  for (testbench::Triangle& triangle : scene.triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex = move(vertex);
  for (testbench::Light& light : scene.lights) light.position = move(light.position);
}

/// Places are multiples of 2^-28, so that they can be moved far without rounding, and the box of the
/// triangles has its middle at the origin.
Scene centred(Scene scene) {
  const auto rounded = [](const glm::dvec3& place) { return glm::round(place * 0x1p28) * 0x1p-28; };
  move_places(scene, rounded);
  const glm::dvec3 middle = testbench::bounds_of(scene.triangles).middle();
  move_places(scene, [&](const glm::dvec3& place) { return place - middle; });
  return scene;
}

Scene moved(Scene scene, const glm::dvec3& by) {
  move_places(scene, [&](const glm::dvec3& place) { return place + by; });
  return scene;
}

const glm::dvec3 kMoves[] = {{1e6, 1e6, 1e6}, {-5e5, 0, 3e5}, {0, 0x1p24, 0}, {100, -1000, 10000}};

RenderOptions with_tree(Traversal traversal, NodeFormat format) {
  RenderOptions options = render_options(Program::full, 2);
  options.program.traversal = traversal;
  options.program.tree.layout.format = format;
  return options;
}

TEST_F(FarScene, HasTheSameImage) {
  const Scene scene = centred(test_support::sphere_under_light(9, {24, 20}));
  for (const Traversal traversal : {Traversal::brute_force, Traversal::refill, Traversal::packets,
                                    Traversal::large_packets, Traversal::ray_streams}) {
    const RenderOptions options = with_tree(traversal, NodeFormat::fp32);
    const RenderResult expected = testbench::render_natively(scene, options);
    for (const glm::dvec3& by : kMoves) {
      const RenderResult found = testbench::render_natively(moved(scene, by), options);
      EXPECT_EQ(found.film.sha256(), expected.film.sha256()) << by.x;
      EXPECT_EQ(found.counts.traversal.leaf_loads, expected.counts.traversal.leaf_loads) << by.x;
    }
  }
}

TEST_F(FarScene, TakesTheSameCycles) {
  const Scene scene = centred(test_support::sphere_under_light(9, {12, 8}));
  const RenderOptions options = with_tree(Traversal::refill, NodeFormat::quantised8);
  const RenderResult expected = testbench::render_on_chip(scene, options);
  new_context();
  const RenderResult found = testbench::render_on_chip(moved(scene, kMoves[0]), options);
  EXPECT_EQ(found.chip->firmware_cycles, expected.chip->firmware_cycles);
}

TEST_F(FarScene, IsMovedOnlyWhereItIsFar) {
  Scene scene = centred(test_support::sphere_under_light(3, {4, 4}));
  const double unit = testbench::normalised(scene).triangles[0].vertex[0].x / scene.triangles[0].vertex[0].x;
  const Scene near = moved(scene, {4, 0, 0});
  EXPECT_EQ(testbench::normalised(near).rounded_at, 0.0);
  const Scene far = testbench::normalised(moved(scene, {1e6, 1, 0}));
  EXPECT_EQ(far.triangles[0].vertex[0].x, scene.triangles[0].vertex[0].x * unit);
  EXPECT_EQ(far.triangles[0].vertex[0].y, (scene.triangles[0].vertex[0].y + 1) * unit);
  EXPECT_GE(far.rounded_at, 1e6 * unit);
}

/// Vertices at 1e6 are rounded to 1e-10, by which a carpet lies off its tilted floor.
TEST_F(FarScene, SurfacesThatCoincideThereStillDo) {
  const glm::dvec3 along = glm::normalize(glm::dvec3(0.3, 1.0, 0.2));
  const glm::dvec3 across = glm::normalize(glm::cross(along, glm::dvec3(1.0, 0.1, 0.4)));
  const glm::dvec3 at(1e6, 3e5, -2e6);
  const auto corner = [&](double u, double v) { return at + u * along + v * across; };
  Scene scene = test_support::sphere_under_light(3, {4, 4});
  scene.materials = {{"lamp", glm::dvec3(0.0), glm::dvec3(1.0)}};
  scene.triangles = {{{corner(-1, -1), corner(1, -1), corner(0, 1)}, 0},
                     {{corner(-0.2, -0.3), corner(0.31, -0.3), corner(0.11, 0.17)}, 0}};
  scene.corners = {};
  const testbench::MonoImage image = testbench::make_normal_mono_image(scene, 96, {});
  EXPECT_TRUE(image.layout.layers.any);
  const testbench::LightSurvey survey = testbench::make_normal_light_survey(scene, {});
  EXPECT_EQ(testbench::make_normal_mono_image(scene, 96, {}, &survey).bytes, image.bytes);
}

}  // namespace far_scene_test
