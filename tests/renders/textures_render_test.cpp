// Whole renders of textured scenes.

#include <gtest/gtest.h>

#include "testbench/mono_image/scene_features.hpp"
#include "testbench/run/render.hpp"
#include "testbench/texture/sample.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace textures_render_test {

using path_tracer::Program;
using path_tracer::TextureSlot;
using path_tracer::Traversal;
using testbench::RenderOptions;
using testbench::Scene;
using testbench::TextureFilter;

constexpr Traversal kTraversals[] = {Traversal::brute_force,   Traversal::temporary_bin,   Traversal::refill,
                                     Traversal::lock_step,     Traversal::shared_treelets, Traversal::packets,
                                     Traversal::large_packets, Traversal::ray_streams};

RenderOptions options_for(Program program, Traversal traversal, int n) {
  RenderOptions options = test_support::render_options(program, 2);
  options.chip.poly.sram_bytes = 32768;  // n = 8 needs more than the CSX600's 6 KiB
  options.program.traversal = traversal;
  options.program.n = n;
  options.program.bin_blocks = std::max(n, 2);
  return options;
}

class TexturedRenders : public test_support::SystemCFixture {};

/// No path meets anything but the sky after the square, so each shows its texel and nothing else. The error
/// is that of the sRGB curve (kernels/textures.hpp).
TEST_F(TexturedRenders, EveryPixelShowsItsTexel) {
  const Scene scene = test_support::textured_square({8, 6}, TextureFilter::nearest);
  for (const Program program : {Program::segments, Program::full}) {
    RenderOptions options = options_for(program, Traversal::refill, 1);
    options.work.samples = 5;
    options.program.roulette_start = 40;
    const testbench::Film film = testbench::render_natively(scene, options).film;
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
      const glm::dvec4 texel = testbench::texel_at(scene.textures[0], pixel % 8, pixel / 8);
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(film.mean(pixel)[channel], texel[channel], 2.3e-7 * texel[channel]) << pixel;
    }
  }
}

/// A pixel as large as a texel sees, of the texel that it is centred on, 3/4 through a linear filter, and 1/8
/// of either neighbour: the integrals of the filter's triangle.
TEST_F(TexturedRenders, LinearFilterHasItsMean) {
  const Scene scene = test_support::textured_square({4, 4}, TextureFilter::linear);
  constexpr int kSamples = 4096;
  RenderOptions options = options_for(Program::segments, Traversal::brute_force, 1);
  options.work.samples = kSamples;
  options.program.roulette_start = 40;
  const testbench::Film film = testbench::render_natively(scene, options).film;
  constexpr double kWeight[] = {0.125, 0.75, 0.125};
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    glm::dvec3 expected(0.0);
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        expected += kWeight[x + 1] * kWeight[y + 1] *
                    glm::dvec3(testbench::texel_at(scene.textures[0], (pixel % 4 + x + 4) % 4,
                                                   (pixel / 4 + y + 4) % 4));
    // A value in [0, 1] has a standard deviation of at most 1/2.
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(film.mean(pixel)[channel], expected[channel], 6.0 * 0.5 / std::sqrt(kSamples)) << pixel;
  }
}

TEST_F(TexturedRenders, AreTheSameForEveryTraversalDepthOfBufferingAndWidth) {
  for (const bool has_textured_light : {false, true}) {
    const Scene scene = test_support::textured_squares({16, 12}, has_textured_light);
    for (const Program program : {Program::segments, Program::direct, Program::full}) {
      const std::string expected =
          testbench::render_natively(scene, options_for(program, Traversal::brute_force, 1)).film.sha256();
      for (const Traversal traversal : kTraversals) {
        for (const int n : {0, 1, 2, 3, 8}) {
          RenderOptions options = options_for(program, traversal, n);
          EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), expected)
              << "program " << int(program) << ", traversal " << int(traversal) << ", n " << n;
          options.chip.chip.pes = n == 2 ? 16 : 256;
          EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(), expected)
              << "program " << int(program) << ", traversal " << int(traversal) << ", n " << n << ", "
              << options.chip.chip.pes << " PEs";
        }
      }
    }
  }
}

TEST_F(TexturedRenders, AreTheSameOnTheChipWithoutHazards) {
  for (const bool has_textured_light : {false, true}) {
    const Scene scene = test_support::textured_squares({16, 12}, has_textured_light);
    for (const Traversal traversal : kTraversals) {
      for (const int n : {0, 1, 2, 3}) {
        RenderOptions options = options_for(Program::full, traversal, n);
        const std::string expected = testbench::render_natively(scene, options).film.sha256();
        options.check_hazards = true;
        new_context();
        EXPECT_EQ(testbench::render_on_chip(scene, options).film.sha256(), expected)
            << "traversal " << int(traversal) << ", n " << n;
      }
    }
  }
}

/// A lamp whose texels the camera sees one by one.
TEST_F(TexturedRenders, EveryPixelShowsWhatItsTexelEmits) {
  Scene scene = test_support::textured_square({8, 6}, TextureFilter::nearest);
  scene.environment.constant = glm::dvec3(0.0);
  testbench::Material& lamp = scene.materials[0];
  lamp.textures.emission = lamp.textures.reflectance;
  lamp.textures.reflectance = {};
  lamp.reflectance = glm::dvec3(0.0);
  lamp.emission = {5.0, 2.0, 0.5};
  for (const Program program : {Program::segments, Program::full}) {
    const testbench::Film film =
        testbench::render_natively(scene, options_for(program, Traversal::refill, 1)).film;
    for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
      const glm::dvec4 texel = testbench::texel_at(scene.textures[0], pixel % 8, pixel / 8);
      for (int channel = 0; channel < 3; ++channel) {
        const double expected = lamp.emission[channel] * texel[channel];
        EXPECT_NEAR(film.mean(pixel)[channel], expected, 2.3e-7 * expected) << pixel;
      }
    }
  }
}

struct Mean {
  glm::dvec3 mean{0.0};
  glm::dvec3 variance{0.0};
};

Mean mean_of(const Scene& scene, const RenderOptions& options) {
  const testbench::Film film = testbench::render_natively(scene, options).film;
  Mean result;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    result.mean += film.mean(pixel) / double(film.pixel_count());
    result.variance +=
        film.variance_of_mean(pixel) / (double(film.pixel_count()) * double(film.pixel_count()));
  }
  return result;
}

void expect_equal_means(const Mean& a, const Mean& b) {
  for (int channel = 0; channel < 3; ++channel) {
    EXPECT_GT(a.mean[channel], 0.0);
    EXPECT_NEAR(a.mean[channel], b.mean[channel], 6.0 * std::sqrt(a.variance[channel] + b.variance[channel]));
  }
}

/// Light that rays meet by chance needs no choice of lights, which textures take part in, and must be as much
/// as light that rays are aimed at.
TEST_F(TexturedRenders, LightOfTexelsIsTheSameByEveryEstimator) {
  const Scene scene = test_support::textured_squares({8, 6}, true);
  RenderOptions options = options_for(Program::segments, Traversal::brute_force, 1);
  options.work.samples = 4096;
  const Mean by_chance = mean_of(scene, options);
  options.program.program = Program::full;
  for (const path_tracer::Estimator estimator :
       {path_tracer::Estimator::light, path_tracer::Estimator::mis, path_tracer::Estimator::per_lobe}) {
    for (const path_tracer::LightSampling sampling :
         {path_tracer::LightSampling::area, path_tracer::LightSampling::solid_angle}) {
      options.program.estimator = estimator;
      options.program.light_sampling = sampling;
      expect_equal_means(mean_of(scene, options), by_chance);
    }
  }
}

/// A plane below a square light of which a texture lights one half, against a light of half the size. The
/// other half's triangles emit where the texture says, and are not missed where they emit nothing.
TEST_F(TexturedRenders, HalfALightIsALightOfHalfTheSize) {
  const auto under_light = [](double from_x, bool is_textured) {
    Scene scene = test_support::textured_square({6, 6}, TextureFilter::nearest);
    scene.environment.constant = glm::dvec3(0.0);
    scene.materials[0].textures = {};
    scene.materials[0].reflectance = glm::dvec3(0.6);
    scene.materials.push_back({"light", glm::dvec3(0.0), glm::dvec3(4.0, 3.0, 2.0)});
    scene.textures = {{"half", testbench::TexelEncoding::srgb, {2, 1, 1, {255, 0}}}};
    testbench::TextureReference& reference = scene.materials[1].textures.emission;
    if (is_textured) reference.texture = 0;
    reference.filter = TextureFilter::nearest;
    // It faces down, above the camera. Coordinate u falls from 1 to 0 along x.
    test_support::add_textured_square(scene, {{{1, -1, 6}, {from_x, -1, 6}, {from_x, 1, 6}, {1, 1, 6}}}, 1);
    return scene;
  };
  RenderOptions options = options_for(Program::full, Traversal::brute_force, 1);
  options.work.samples = 2048;
  const Mean half = mean_of(under_light(0.0, false), options);
  expect_equal_means(mean_of(under_light(-1.0, true), options), half);
}

/// A texture without light makes no lights, and the program casts no shadow rays to them.
TEST_F(TexturedRenders, BlackLightsAreNone) {
  Scene scene = test_support::textured_squares({8, 6}, true);
  const path_tracer::ProgramConfig config;
  EXPECT_TRUE(testbench::features_of(scene, config).lights.any());
  scene.textures[1].image.texels.assign(scene.textures[1].image.texels.size(), 0);
  EXPECT_FALSE(testbench::features_of(scene, config).lights.any());
  const RenderOptions options = options_for(Program::full, Traversal::refill, 1);
  EXPECT_EQ(testbench::render_natively(scene, options).counts.shadow_rays, 0u);
}

/// A white texel is exactly 1 where channels are linear.
TEST_F(TexturedRenders, WhiteTexturesOfSingleChannelsChangeNoBit) {
  Scene scene = test_support::textured_squares({16, 12});
  for (testbench::Texture& texture : scene.textures)
    std::fill(texture.image.texels.begin(), texture.image.texels.end(), std::uint8_t{255});
  Scene bare = scene;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    scene.materials[i].textures.reflectance = {};
    bare.materials[i].textures = {};
  }
  RenderOptions options = options_for(Program::full, Traversal::refill, 1);
  options.program.folds_constant_textures = false;
  const path_tracer::TextureSlots slots = testbench::features_of(scene, options.program).textures;
  EXPECT_FALSE(slots.has(TextureSlot::reflectance));
  EXPECT_TRUE(slots.has(TextureSlot::metallic) && slots.has(TextureSlot::roughness) &&
              slots.has(TextureSlot::transmission));
  EXPECT_FALSE(testbench::features_of(bare, options.program).textures.any());
  EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(),
            testbench::render_natively(bare, options).film.sha256());
}

/// One image for both, as in glTF, is looked up once. A copy of the image for one of them shows the same.
TEST_F(TexturedRenders, MetallicAndRoughnessOfOneImageShareALookUp) {
  Scene scene = test_support::textured_squares({16, 12});
  for (std::size_t i = 1; i < 7; ++i) {
    testbench::MaterialTextures& textures = scene.materials[i].textures;
    textures.roughness.texture = 2;
    textures.roughness.channel = 1;
    if (i == 3) textures.metallic = {};
    if (i == 4) textures.roughness = {};
  }
  Scene apart = scene;
  apart.textures.push_back(apart.textures[2]);
  for (std::size_t i = 1; i < 7; ++i)
    if (i != 4) apart.materials[i].textures.roughness.texture = 4;
  const RenderOptions options = options_for(Program::full, Traversal::refill, 1);
  const path_tracer::Features together = testbench::features_of(scene, options.program);
  const path_tracer::Features two = testbench::features_of(apart, options.program);
  EXPECT_TRUE(together.textures.roughness_with_metallic);
  EXPECT_FALSE(two.textures.roughness_with_metallic);
  EXPECT_EQ(path_tracer::RecordSizes(two).surface - path_tracer::RecordSizes(together).surface,
            int{sizeof(path_tracer::TextureRecord)});
  EXPECT_EQ(testbench::render_natively(scene, options).film.sha256(),
            testbench::render_natively(apart, options).film.sha256());
}

/// Lobes are those that texels make: a scene without smooth texels has no mirror, and so on.
TEST_F(TexturedRenders, AreBuiltForTheTexelsOfTheirTextures) {
  Scene scene = test_support::textured_square({2, 2}, TextureFilter::linear);
  scene.textures.push_back({"", testbench::TexelEncoding::linear, {2, 1, 1, {0, 255}}});
  testbench::Material& material = scene.materials[0];
  material.textures = {};
  material.metallic = 1.0;
  const path_tracer::ProgramConfig config;
  path_tracer::Lobes lobes = testbench::features_of(scene, config).lobes;
  EXPECT_TRUE(!lobes.diffuse && lobes.glossy && !lobes.mirror);
  material.textures.metallic.texture = 1;
  lobes = testbench::features_of(scene, config).lobes;
  EXPECT_TRUE(lobes.diffuse && lobes.glossy && !lobes.mirror);
  material.textures.roughness.texture = 1;
  lobes = testbench::features_of(scene, config).lobes;
  EXPECT_TRUE(lobes.diffuse && lobes.glossy && lobes.mirror);
  scene.textures[1].image.texels = {0, 0};
  const path_tracer::Features features = testbench::features_of(scene, config);
  EXPECT_TRUE(features.lobes.only_diffuse());
  EXPECT_FALSE(features.textures.any());
}

}  // namespace textures_render_test
