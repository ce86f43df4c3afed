// An orthographic camera: parallel rays, so size on the film does not depend on distance.

#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace orthographic_test {

using path_tracer::Program;
using test_support::render_options;
using testbench::Film;
using testbench::RenderResult;
using testbench::Scene;

class Orthographic : public test_support::SystemCFixture {};

const glm::dvec3 kRadiance(1.0, 2.0, 3.0);

/// A camera at the origin that looks along -z at a film of 16 x 12 pixels of side 1/4, and a rectangle
/// `depth` before it that emits. Its edges lie on pixel borders: columns 3 to 8, rows 2 to 6.
Scene rectangle(double depth) {
  Scene scene;
  scene.name = "rectangle";
  scene.film = {16, 12};
  scene.camera.direction = {0, 0, -1};
  scene.camera.orthographic_height = 3.0;
  scene.materials = {{"light", glm::dvec3(0.0), kRadiance}};
  const glm::dvec3 low(-2.0 + 3 * 0.25, 1.5 - 7 * 0.25, -depth);
  const glm::dvec3 high(-2.0 + 9 * 0.25, 1.5 - 2 * 0.25, -depth);
  const glm::dvec3 right(high.x, low.y, -depth);
  const glm::dvec3 left(low.x, high.y, -depth);
  scene.triangles = {{{low, right, high}, 0}, {{low, high, left}, 0}};
  return scene;
}

void expect_rectangle(const Film& film) {
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 16; ++column) {
      const bool is_covered = column >= 3 && column <= 8 && row >= 2 && row <= 6;
      EXPECT_EQ(film.mean(16 * row + column), is_covered ? kRadiance : glm::dvec3(0.0))
          << column << ", " << row;
    }
}

TEST_F(Orthographic, ARectangleCoversItsPixelsAtEveryDistance) {
  for (const double depth : {0.125, 1.0, 1000.0})
    expect_rectangle(testbench::render_natively(rectangle(depth), render_options(Program::full, 4)).film);
}

TEST_F(Orthographic, TheChipShowsTheSame) {
  testbench::RenderOptions options = render_options(Program::full, 4);
  expect_rectangle(testbench::render_on_chip(rectangle(5), options).film);
  options.program.traversal = path_tracer::Traversal::refill;
  new_context();
  expect_rectangle(testbench::render_on_chip(rectangle(5), options).film);
}

TEST_F(Orthographic, WhatLiesBehindTheFilmIsNotSeen) {
  const Film film = testbench::render_natively(rectangle(-1), render_options(Program::segments, 1)).film;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) EXPECT_EQ(film.mean(pixel), glm::dvec3(0.0));
}

/// The film is wider than all that it sees: rays start farther from the mesh than the camera's position.
TEST_F(Orthographic, AFilmMuchLargerThanTheSceneFindsIt) {
  Scene scene = rectangle(1);
  for (auto& triangle : scene.triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex += glm::dvec3(4e6 - 0.25, 3e6 - 0.25, 0.0);
  scene.camera.orthographic_height = 8e6;  // the rectangle lies around the centre of a pixel
  scene.film = {11, 8};
  testbench::RenderOptions options = render_options(Program::full, 64);
  const std::string expected = testbench::render_natively(scene, options).film.sha256();
  options.program.traversal = path_tracer::Traversal::refill;
  EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), expected);
}

}  // namespace orthographic_test
