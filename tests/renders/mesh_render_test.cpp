// Renders a mesh of more than 1,000 triangles by brute force.

#include <algorithm>

#include "testbench/mono_image/faces.hpp"
#include "testbench/mono_image/mono_image.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace mesh_render_test {

using path_tracer::Program;
using test_support::render_options;
using testbench::RenderResult;
using testbench::Scene;

class MeshRender : public test_support::SystemCFixture {};

TEST_F(MeshRender, ChipAndNativeRunShowTheSameMesh) {
  const Scene scene = test_support::sphere_under_light(17, {16, 12});
  ASSERT_GE(scene.triangles.size(), 1000u);
  const testbench::RenderOptions options = render_options(Program::full, 4);
  const RenderResult chip = testbench::render_on_chip(scene, options);
  const RenderResult native = testbench::render_natively(scene, options);
  EXPECT_EQ(chip.film.sha256(), native.film.sha256());
  EXPECT_EQ(chip.counts.segments, native.counts.segments);
  EXPECT_EQ(chip.film.rejected_samples(), 0u);
  // The mesh is twice as large as the data cache, so every block fetches it again.
  EXPECT_GT(scene.triangles.size() * sizeof(path_tracer::TriangleRecord),
            std::size_t(options.chip.control.data_cache_bytes));
  EXPECT_GT(chip.chip->control.data_cache_misses, scene.triangles.size());
  EXPECT_EQ(chip.chip->control.total(), chip.chip->firmware_cycles);
}

TEST_F(MeshRender, SphereIsSeenWhereItIs) {
  const Scene scene = test_support::sphere_under_light(17, {32, 24});
  const RenderResult result = testbench::render_natively(scene, render_options(Program::full, 32));
  int red_pixels = 0;
  for (int pixel = 0; pixel < result.film.pixel_count(); ++pixel) {
    const glm::dvec3 mean = result.film.mean(pixel);
    if (mean.x > 3 * mean.y) ++red_pixels;
  }
  // The sphere appears as a disc of radius 0.71 (0.7 at a distance of 4) in a picture of height 2 * 4 *
  // tan(20 degrees) = 2.91: 107 of 24 x 32 pixels.
  EXPECT_NEAR(red_pixels, 107, 12);
}

/// Each triangle emits a different radiance, and a ray from a point close to it finds it.
TEST_F(MeshRender, NoTriangleIsSkipped) {
  Scene scene = test_support::triangle_soup(1200, 11, {1, 1});
  scene.materials.clear();
  for (std::size_t i = 0; i < scene.triangles.size(); ++i) {
    scene.materials.push_back({"glowing", glm::dvec3(0.0), glm::dvec3(double(i + 1))});
    scene.triangles[i].material = std::int32_t(i);
  }
  scene.camera.vertical_field_of_view_radians = 1e-6;
  for (std::size_t i = 0; i < scene.triangles.size(); i = i < 40 || i > 1160 ? i + 1 : i + 37) {
    const testbench::Triangle& triangle = scene.triangles[i];
    const glm::dvec3 middle = (triangle.vertex[0] + triangle.vertex[1] + triangle.vertex[2]) / 3.0;
    const glm::dvec3 normal = glm::normalize(testbench::area_normal(triangle));
    scene.camera.position = middle + normal * 1e-6;
    scene.camera.direction = -normal;
    const glm::dvec3 across = triangle.vertex[1] - triangle.vertex[0];
    scene.camera.up = glm::normalize(across - glm::dot(across, normal) * normal);
    const RenderResult result = testbench::render_natively(scene, render_options(Program::segments, 1));
    EXPECT_EQ(result.film.mean(0).x, double(i + 1));
  }
}

}  // namespace mesh_render_test
