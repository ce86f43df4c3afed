// Whole renders of surfaces that let rays through: masks, and surfaces that are there by chance.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "testbench/mono_image/scene_features.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"

namespace coverage_render_test {

using path_tracer::Estimator;
using path_tracer::Program;
using path_tracer::Sampler;
using testbench::AlphaMode;
using testbench::Film;
using testbench::Material;
using testbench::RenderOptions;
using testbench::Scene;

Material sheet(double alpha) {
  Material material;
  material.alpha_mode = AlphaMode::blend;
  material.alpha = alpha;
  return material;
}

Material lamp(double radiance) {
  Material material;
  material.emission = glm::dvec3(radiance);
  return material;
}

/// Adds a square of half side `half` across the z axis, whose front faces +z, or -z.
void add_square(Scene& scene, double z, double half, const Material& material, bool faces_up = true) {
  const double y = faces_up ? half : -half;
  test_support::add_textured_square(scene, {{{-half, -y, z}, {half, -y, z}, {half, y, z}, {-half, y, z}}},
                                    static_cast<std::int32_t>(scene.materials.size()));
  scene.materials.push_back(material);
}

/// A camera at z = 5 that sees the square from -1 to 1 across the z axis, along parallel rays.
Scene seen_from_above(testbench::FilmSize film) {
  Scene scene;
  scene.name = "coverage";
  scene.film = film;
  scene.camera.position = {0, 0, 5};
  scene.camera.direction = {0, 0, -1};
  scene.camera.orthographic_height = 2.0;
  return scene;
}

/// A grey floor; a small lamp above it and above the camera, whom nothing but the floor is in sight of.
Scene floor_under_lamp() {
  Scene scene = seen_from_above({4, 4});
  Material floor;
  floor.reflectance = glm::dvec3(0.6);
  add_square(scene, 0.0, 1.0, floor);
  add_square(scene, 9.0, 0.7, lamp(40.0), false);
  return scene;
}

struct Mean {
  double value = 0.0;
  double variance = 0.0;
};

/// Of the red channel. Numbers are independent, so that the film's variances mean something.
Mean mean_of(const Scene& scene, Program program, Estimator estimator, int samples) {
  RenderOptions options = test_support::render_options(program, samples);
  options.program.sampler = Sampler::philox;
  options.program.estimator = estimator;
  const Film film = testbench::render_natively(scene, options).film;
  Mean mean;
  const double pixels = film.pixel_count();
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    mean.value += film.mean(pixel).x / pixels;
    mean.variance += film.variance_of_mean(pixel).x / (pixels * pixels);
  }
  return mean;
}

/// Calls test(program, estimator) for each way in which light reaches a path.
template <class Test>
void for_each_way(const Test& test) {
  test(Program::segments, Estimator::light);
  for (const Estimator estimator : {Estimator::light, Estimator::mis, Estimator::per_lobe})
    test(Program::full, estimator);
}

TEST(CoverageRenders, SheetsPassTheProductOfWhatTheyLeaveOpen) {
  for (const bool is_lamp : {true, false}) {
    Scene scene = seen_from_above({4, 4});
    if (is_lamp)
      add_square(scene, 0.0, 1.0, lamp(3.0));
    else
      scene.environment.constant = glm::dvec3(3.0);
    double expected = 3.0;
    for (const double alpha : {0.3, 0.6}) {
      add_square(scene, 4.0 - alpha, 1.0, sheet(alpha), alpha < 0.5);
      expected *= 1.0 - alpha;
      for_each_way([&](Program program, Estimator estimator) {
        if (!is_lamp && program == Program::full) return;
        const Mean mean = mean_of(scene, program, estimator, 4096);
        EXPECT_NEAR(mean.value, expected, 5 * std::sqrt(mean.variance)) << is_lamp << int(estimator);
        EXPECT_GT(mean.variance, 0.0);
      });
    }
  }
}

/// A sheet that emits shows its emission where it is, and what is behind it elsewhere.
TEST(CoverageRenders, AGlowingSheetMixesItsLightWithWhatIsBehind) {
  Scene scene = seen_from_above({4, 4});
  add_square(scene, 0.0, 1.0, lamp(3.0));
  Material glowing = sheet(0.25);
  glowing.emission = glm::dvec3(8.0);
  add_square(scene, 2.0, 1.0, glowing);
  for_each_way([&](Program program, Estimator estimator) {
    const Mean mean = mean_of(scene, program, estimator, 4096);
    EXPECT_NEAR(mean.value, 0.25 * 8.0 + 0.75 * 3.0, 5 * std::sqrt(mean.variance)) << int(estimator);
  });
}

/// The lamp's light on the floor, through one sheet and two. The sheets reflect nothing, so that all light
/// comes from the lamp.
TEST(CoverageRenders, AShadowIsAsDarkAsItsSheetsAreThere) {
  Scene scene = floor_under_lamp();
  const Mean bare = mean_of(scene, Program::full, Estimator::light, 4096);
  double expected = bare.value;
  for (const double alpha : {0.3, 0.6}) {
    add_square(scene, 6.0 + alpha, 20.0, sheet(alpha), alpha < 0.5);
    expected *= 1.0 - alpha;
    for (const Estimator estimator : {Estimator::light, Estimator::mis, Estimator::per_lobe}) {
      const Mean mean = mean_of(scene, Program::full, estimator, 4096);
      EXPECT_NEAR(mean.value, expected, 5 * std::sqrt(mean.variance + bare.variance)) << int(estimator);
    }
    const Mean by_hits = mean_of(scene, Program::segments, Estimator::light, 65536);
    EXPECT_NEAR(by_hits.value, expected, 5 * std::sqrt(by_hits.variance + bare.variance));
  }
}

/// A floor without a lamp, under lights without triangles; what is behind a near light is not in its way.
TEST(CoverageRenders, LightsWithoutTrianglesShineThroughSheets) {
  testbench::Light point;
  point.position = {0.2, 0.1, 9.0};
  point.intensity = glm::dvec3(50.0);
  testbench::Light parallel;
  parallel.kind = testbench::LightKind::directional;
  parallel.direction = glm::normalize(glm::dvec3(0.3, 0.1, -1.0));
  testbench::Light sun = parallel;
  sun.kind = testbench::LightKind::sun;
  sun.angular_diameter_radians = 0.2;
  testbench::RadianceImage sky{4, 2, std::vector<float>(24, 1.0f)};
  sky.rgb[3] = 9.0f;
  for (const int light : {0, 1, 2, 3, 4}) {
    SCOPED_TRACE(light);
    Scene scene = floor_under_lamp();
    if (light < 4) scene.triangles.resize(2);
    if (light == 0 || light == 4) scene.lights = {point};
    if (light == 1) scene.lights = {parallel};
    if (light == 2) scene.lights = {sun};
    if (light == 3) scene.environment.image = sky;
    if (light == 3) scene.environment.rotation = {{1, 0, 0}, {0, 0, 1}, {0, -1, 0}};
    const Mean bare = mean_of(scene, Program::full, Estimator::per_lobe, 4096);
    EXPECT_GT(bare.value, 0.01);
    double expected = bare.value;
    for (const double alpha : {0.3, 0.6}) {
      add_square(scene, 6.0 + alpha, 4000.0, sheet(alpha), alpha < 0.5);
      expected *= 1.0 - alpha;
      const Mean mean = mean_of(scene, Program::full, Estimator::per_lobe, 4096);
      EXPECT_NEAR(mean.value, expected, 5 * std::sqrt(mean.variance + bare.variance));
    }
    if (light != 0) continue;
    add_square(scene, 9.5, 4000.0, sheet(0.9));
    const Mean mean = mean_of(scene, Program::full, Estimator::per_lobe, 4096);
    EXPECT_NEAR(mean.value, expected, 5 * std::sqrt(mean.variance + bare.variance));
  }
}

/// Four sheets in the way to the lamp, the lowest of which is also between camera and floor.
TEST(CoverageRenders, EitherSamplerDecidesLayerByLayer) {
  Scene scene = floor_under_lamp();
  scene.film = {32, 32};
  const Mean bare = mean_of(scene, Program::full, Estimator::light, 64);
  for (const double z : {4.0, 6.0, 6.5, 7.0}) add_square(scene, z, 20.0, sheet(0.5));
  for (const Sampler sampler : {Sampler::philox, Sampler::sobol}) {
    RenderOptions options = test_support::render_options(Program::full, 64);
    options.program.sampler = sampler;
    const Film film = testbench::render_natively(scene, options).film;
    double mean = 0.0;
    double variance = bare.variance / (32 * 32);
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
      mean += film.mean(pixel).x / film.pixel_count();
      variance += film.variance_of_mean(pixel).x / (double(film.pixel_count()) * film.pixel_count());
    }
    EXPECT_NEAR(mean, bare.value / 32, 5 * std::sqrt(variance)) << int(sampler);
  }
}

/// A lamp of which half is there lights like one of half the radiance, by hits and by shadow rays.
TEST(CoverageRenders, ALampThatIsHalfThereGivesHalfTheLight) {
  Scene scene = floor_under_lamp();
  const Mean bare = mean_of(scene, Program::full, Estimator::light, 16384);
  scene.materials.back().alpha_mode = AlphaMode::blend;
  scene.materials.back().alpha = 0.5;
  for_each_way([&](Program program, Estimator estimator) {
    const Mean mean = mean_of(scene, program, estimator, program == Program::full ? 16384 : 65536);
    EXPECT_NEAR(mean.value, 0.5 * bare.value, 5 * std::sqrt(mean.variance + 0.25 * bare.variance))
        << int(program) << int(estimator);
  });
}

/// Hits and shadow rays are weighed by how far the light is from where the direction was chosen, not from the
/// last sheet: a glossy floor close to a large lamp, where both weights matter.
TEST(CoverageRenders, WaysAgreeOnGlossBehindSheets) {
  Scene scene = seen_from_above({8, 8});
  Material floor;
  floor.reflectance = glm::dvec3(0.9);
  floor.metallic = 1.0;
  floor.roughness = 0.5;
  add_square(scene, 0.0, 1.0, floor);
  add_square(scene, 7.5, 3.0, lamp(2.0), false);
  add_square(scene, 6.0, 20.0, sheet(0.2));
  add_square(scene, 7.0, 20.0, sheet(0.2), false);
  const Mean by_hits = mean_of(scene, Program::segments, Estimator::light, 8192);
  EXPECT_GT(by_hits.value, 0.1);
  for (const Estimator estimator : {Estimator::light, Estimator::mis, Estimator::per_lobe}) {
    const Mean mean = mean_of(scene, Program::full, estimator, 8192);
    EXPECT_NEAR(mean.value, by_hits.value, 5 * std::sqrt(mean.variance + by_hits.variance)) << int(estimator);
  }
}

/// A board of a texel for each pixel, in front of a lamp: no random number decides.
TEST(CoverageRenders, AMaskShowsAPixelOrLeavesItOpen) {
  Scene scene = seen_from_above({8, 8});
  add_square(scene, 0.0, 1.0, lamp(3.0));
  Material board = lamp(1.0);
  board.alpha_mode = AlphaMode::mask;
  board.alpha = 0.8;
  board.alpha_cutoff = 0.8 * 100 / 255.0;  // alpha is above by no rounding: 100 shows
  board.textures.alpha.texture = 0;
  board.textures.alpha.channel = 3;
  board.textures.alpha.filter = testbench::TextureFilter::nearest;
  testbench::Texture texture{"board", testbench::TexelEncoding::srgb, {8, 8, 4, {}}};
  int open = 0;
  for (int texel = 0; texel < 64; ++texel) {
    const bool is_open = (texel / 8 + texel) % 2 == 0;
    open += is_open ? 1 : 0;
    for (int channel = 0; channel < 3; ++channel) texture.image.texels.push_back(128);
    texture.image.texels.push_back(is_open ? 99 : 101);
  }
  scene.textures.push_back(texture);
  EXPECT_EQ(open, 32);
  add_square(scene, 2.0, 1.0, board);
  for_each_way([&](Program program, Estimator estimator) {
    RenderOptions options = test_support::render_options(program, 4);
    options.program.estimator = estimator;
    const Film film = testbench::render_natively(scene, options).film;
    for (int pixel = 0; pixel < 64; ++pixel)
      EXPECT_EQ(film.mean(pixel).x, texture.image.texels[std::size_t(pixel) * 4 + 3] < 100 ? 3.0 : 1.0)
          << pixel;
  });
  EXPECT_FALSE(testbench::features_of(scene, {}).blended_coverage);
}

/// A mask's alpha that equals the cutoff shows the surface; one that is below shows none of it, to the bit.
TEST(CoverageRenders, AMaskWithoutTextureIsThereOrNot) {
  Scene scene = seen_from_above({2, 2});
  add_square(scene, 0.0, 1.0, lamp(3.0));
  add_square(scene, 1.0, 1.0, sheet(0.25));
  Material& mask = scene.materials.back();
  mask.alpha_mode = AlphaMode::mask;
  mask.alpha_cutoff = 0.25;
  EXPECT_EQ(mean_of(scene, Program::full, Estimator::light, 2).value, 0.0);
  mask.alpha_cutoff = std::nextafter(0.25, 1.0);
  EXPECT_EQ(mean_of(scene, Program::full, Estimator::light, 2).value, 3.0);
}

/// The camera is in boxes that are not there. No roulette ends a path, and each pass makes its way.
TEST(CoverageRenders, PathsLeaveBoxesThatAreNotThere) {
  Scene scene = test_support::closed_cube(0.5, 0.0, {8, 8});
  const std::vector<testbench::Triangle> cube = scene.triangles;
  for (const double scale : {1.5, 2.0, 0.999999})
    for (testbench::Triangle triangle : cube) {
      for (glm::dvec3& vertex : triangle.vertex) vertex *= scale;
      scene.triangles.push_back(triangle);
    }
  for (Material& material : scene.materials) {
    material.alpha_mode = AlphaMode::blend;
    material.alpha = 0.0;
  }
  scene.environment.constant = glm::dvec3(0.7);
  RenderOptions options = test_support::render_options(Program::full, 4);
  options.program.slot_vertices = 4;
  const Film film = testbench::render_natively(scene, options).film;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) EXPECT_EQ(film.mean(pixel).x, 0.7);
}

/// A light of two sides is two sheets back to back (testbench/scene/gltf_mesh.cpp). It is there once.
TEST(CoverageRenders, ALightOfTwoSidesIsThereOnce) {
  for (const bool is_seen_from_front : {true, false}) {
    Scene scene = seen_from_above({4, 4});
    add_square(scene, 0.0, 1.0, lamp(3.0));
    Material glowing = sheet(0.25);
    glowing.emission = glm::dvec3(8.0);
    glowing.is_side_of_light = true;
    add_square(scene, 2.0 + 0x1p-30, 1.0, glowing, true);
    add_square(scene, 2.0, 1.0, glowing, false);
    if (!is_seen_from_front)
      std::rotate(scene.triangles.begin() + 2, scene.triangles.begin() + 4, scene.triangles.end());
    const Mean mean = mean_of(scene, Program::segments, Estimator::light, 4096);
    EXPECT_NEAR(mean.value, 0.25 * 8.0 + 0.75 * 3.0, 5 * std::sqrt(mean.variance));
  }
}

/// Sheets back to back in one plane, as leaves often are, are one surface to a ray.
TEST(CoverageRenders, SheetsThatCoincideAreThereOnce) {
  Scene seen = seen_from_above({4, 4});
  add_square(seen, 0.0, 1.0, lamp(3.0));
  Scene shadow = floor_under_lamp();
  const Mean bare = mean_of(shadow, Program::full, Estimator::light, 4096);
  for (const bool faces_up : {true, false}) {
    add_square(seen, 2.0, 1.0, sheet(0.25), faces_up);
    add_square(shadow, 6.0, 20.0, sheet(0.25), faces_up);
  }
  for_each_way([&](Program program, Estimator estimator) {
    const Mean mean = mean_of(seen, program, estimator, 4096);
    EXPECT_NEAR(mean.value, 0.75 * 3.0, 5 * std::sqrt(mean.variance)) << int(estimator);
  });
  const Mean mean = mean_of(shadow, Program::full, Estimator::light, 4096);
  EXPECT_NEAR(mean.value, 0.75 * bare.value, 5 * std::sqrt(mean.variance + bare.variance));
}

/// A cloth close to a wall hides it in part; the wall behind is not passed.
TEST(CoverageRenders, ASheetJustAboveAWallLeavesTheWall) {
  Scene scene = seen_from_above({4, 4});
  add_square(scene, 0.0, 1.0, lamp(3.0));
  add_square(scene, 1e-9, 1.0, sheet(0.25));
  scene.environment.constant = glm::dvec3(100.0);
  const Mean mean = mean_of(scene, Program::segments, Estimator::light, 4096);
  EXPECT_NEAR(mean.value, 0.75 * 3.0, 5 * std::sqrt(mean.variance));
}

/// Where a segment passes, no shadow ray is left out, for none is due.
TEST(CoverageRenders, SegmentsThatPassAreNoCulledShadowRays) {
  Scene scene = floor_under_lamp();
  for (const double z : {1.0, 2.0, 3.0}) add_square(scene, z, 1.0, sheet(0.0));
  RenderOptions options = test_support::render_options(Program::full, 16);
  options.program.cull_shadow_rays = false;
  EXPECT_EQ(testbench::render_natively(scene, options).counts.culled_shadow_rays, 0u);
}

/// Alpha that lets nothing through is no coverage, whatever the mode.
TEST(CoverageRenders, SurfacesThatAreAllThereCostNothing) {
  Scene scene = floor_under_lamp();
  scene.materials[0].alpha_mode = AlphaMode::blend;
  EXPECT_TRUE(testbench::features_of(scene, {}).plain());
  scene.materials[0].alpha_mode = AlphaMode::mask;
  scene.materials[0].alpha = scene.materials[0].alpha_cutoff = 0.5;
  EXPECT_TRUE(testbench::features_of(scene, {}).plain());
  scene.materials[0].alpha = 0.4;
  path_tracer::Features features = testbench::features_of(scene, {});
  EXPECT_TRUE(features.coverage && !features.blended_coverage && !features.plain());
  scene.materials[0].alpha_mode = AlphaMode::opaque;
  EXPECT_TRUE(testbench::features_of(scene, {}).plain());
}

}  // namespace coverage_render_test
