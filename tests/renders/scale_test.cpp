// A scene's unit of length changes no bit of its image and no cycle, as far as coordinates may go.

#include <cmath>

#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace scale_test {

using path_tracer::Program;
using path_tracer::Traversal;
using test_support::render_options;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;

class Scale : public test_support::SystemCFixture {};

Scene scaled(Scene scene, int exponent) {
  const double scale = std::ldexp(1.0, exponent);
  scene.camera.position *= scale;
  if (scene.camera.orthographic_height) *scene.camera.orthographic_height *= scale;
  for (testbench::Triangle& triangle : scene.triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex *= scale;
  return scene;
}

RenderOptions with_tree(Traversal traversal) {
  RenderOptions options = render_options(Program::full, 2);
  options.program.traversal = traversal;
  return options;
}

constexpr int kExponents[] = {-300, -299, -134, -67, -1, 1, 40, 133, 299, 300};

void expect_equal_images(const Scene& scene, const RenderOptions& options) {
  const std::string expected = testbench::render_natively(scene, options).film.sha256();
  for (const int exponent : kExponents)
    EXPECT_EQ(testbench::render_natively(scaled(scene, exponent), options).film.sha256(), expected)
        << "2^" << exponent;
}

TEST_F(Scale, TheCornellBoxIsTheSameInEveryUnit) {
  const Scene scene = test_support::small_cornell_box({24, 20});
  for (const Program program : {Program::segments, Program::full})
    expect_equal_images(scene, render_options(program, 4));
}

TEST_F(Scale, ASceneWithATreeIsTheSameInEveryUnit) {
  Scene scene = test_support::sphere_under_light(9, {24, 20});
  for (const Traversal traversal :
       {Traversal::refill, Traversal::packets, Traversal::large_packets, Traversal::ray_streams})
    expect_equal_images(scene, with_tree(traversal));
  scene.camera.orthographic_height = 3.0;
  expect_equal_images(scene, with_tree(Traversal::refill));
}

TEST_F(Scale, TheChipTakesTheSameCyclesInEveryUnit) {
  const Scene scene = test_support::sphere_under_light(9, {12, 8});
  const RenderOptions options = with_tree(Traversal::refill);
  const RenderResult expected = testbench::render_on_chip(scene, options);
  for (const int exponent : {-300, 300}) {
    new_context();
    const RenderResult found = testbench::render_on_chip(scaled(scene, exponent), options);
    EXPECT_EQ(found.chip->firmware_cycles, expected.chip->firmware_cycles);
    EXPECT_EQ(found.film.sha256(), expected.film.sha256());
  }
}

}  // namespace scale_test
