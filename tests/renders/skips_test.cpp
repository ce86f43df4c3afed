// What the firmware leaves out changes no image.

#include "testbench/validation/skips.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"

namespace skips_test {

using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;
using testbench::Skip;

/// A texture of 2 x 2 texels; its second row varies.
testbench::Texture texture(std::uint8_t upper, std::uint8_t lower) {
  return {"texture", testbench::TexelEncoding::srgb, {2, 2, 1, {upper, upper, lower, 255}}};
}

/// A sphere of varnish with a texture, whose block of slots also holds hits of diffuse walls, one of them
/// with a texture of one colour.
Scene varnished_sphere() {
  Scene scene = test_support::sphere_under_light(3, {12, 12});
  testbench::Material& sphere = scene.materials.at(std::size_t(scene.triangles.front().material));
  sphere.specular = 1.0;
  sphere.roughness = 0.3;
  scene.textures = {texture(200, 150), texture(255, 255)};
  scene.corners.coordinates[0].resize(scene.triangles.size());
  sphere.textures.reflectance.texture = 0;
  scene.materials.at(0).textures.reflectance.texture = 1;
  return scene;
}

RenderOptions options_with_tree() {
  RenderOptions options = test_support::render_options(path_tracer::Program::full, 4);
  options.program.traversal = path_tracer::Traversal::refill;
  options.program.tree.resident_nodes = 2;
  options.program.tree.treelet_nodes = 1;
  options.program.tree.stack_entries = 2;
  return options;
}

TEST(Skips, ChangeNoImage) {
  for (const Scene& scene : {varnished_sphere(), test_support::small_cornell_box({12, 12})}) {
    const RenderResult with = render_natively(scene, options_with_tree());
    for (const Skip& skip : testbench::skip_table()) {
      RenderOptions options = options_with_tree();
      skip.switch_off(options.program);
      const RenderResult without = render_natively(scene, options);
      EXPECT_TRUE(!skip.is_exact || without.film.sha256() == with.film.sha256()) << skip.name;
      for (int pixel = 0; pixel < with.film.pixel_count(); ++pixel)
        for (int channel = 0; channel < 3; ++channel)
          EXPECT_NEAR(without.film.mean(pixel)[channel], with.film.mean(pixel)[channel],
                      1e-9 * (1.0 + with.film.mean(pixel)[channel]))
              << skip.name << ", pixel " << pixel;
    }
  }
}

TEST(Skips, AreCounted) {
  const Scene scene = varnished_sphere();
  const RenderResult with = render_natively(scene, options_with_tree());
  for (const Skip& skip : testbench::skip_table()) {
    if (skip.count == nullptr) continue;
    RenderOptions options = options_with_tree();
    skip.switch_off(options.program);
    const testbench::SkipCount count = skip.count(with);
    const testbench::SkipCount without = skip.count(render_natively(scene, options));
    EXPECT_GT(count.skipped, 0u) << skip.name;
    EXPECT_GT(count.all, count.skipped) << skip.name;
    EXPECT_EQ(without.skipped, 0u) << skip.name;
  }
}

/// A shadow ray that is not cast is one that found no light: all hits but the lights' own and those of black
/// surfaces.
TEST(Skips, EveryHitHasAShadowRayOrIsCounted) {
  const Scene scene = test_support::closed_sphere(0.5, 1.0, 1, {8, 8});
  const RenderResult result = render_natively(scene, options_with_tree());
  EXPECT_EQ(result.counts.shadow_rays + result.counts.culled_shadow_rays, result.counts.segments);
}

}  // namespace skips_test
