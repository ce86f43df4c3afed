// Textures of one colour: factors of their materials, of which the image tells nothing.

#include "testbench/mono_image/constant_textures.hpp"

#include <gtest/gtest.h>

#include "firmware/path_tracer/records/texel_value.hpp"
#include "testbench/mono_image/scene_features.hpp"
#include "testbench/run/render.hpp"
#include "tests/support/native_paths.hpp"
#include "tests/support/scenes.hpp"
#include "tests/support/systemc_fixture.hpp"

namespace constant_textures_test {

using path_tracer::Program;
using path_tracer::TextureSlot;
using testbench::AlphaMode;
using testbench::Material;
using testbench::RenderOptions;
using testbench::RenderResult;
using testbench::Scene;
using testbench::TexelEncoding;
using testbench::TextureReference;

/// An image of one colour. @param alpha of the first texel; all others have 255
testbench::Texture texture_of(const std::array<std::uint8_t, 3>& rgb, int width, int height,
                              TexelEncoding encoding, int alpha = 255) {
  testbench::Texture texture{"one colour", encoding, {width, height, 4, {}}};
  for (int texel = 0; texel < width * height; ++texel) {
    texture.image.texels.insert(texture.image.texels.end(), rgb.begin(), rgb.end());
    texture.image.texels.push_back(static_cast<std::uint8_t>(texel == 0 ? alpha : 255));
  }
  return texture;
}

std::int32_t add_texture(Scene& scene, const testbench::Texture& texture) {
  scene.textures.push_back(texture);
  return static_cast<std::int32_t>(scene.textures.size()) - 1;
}

/// Squares with textures of many kinds, of which every second one has a single colour.
Scene squares(bool has_textured_light) {
  Scene scene = test_support::textured_squares({16, 12}, has_textured_light);
  const std::int32_t colour = add_texture(scene, texture_of({181, 90, 7}, 3, 2, TexelEncoding::srgb));
  const std::int32_t numbers = add_texture(scene, texture_of({200, 120, 77}, 1, 1, TexelEncoding::linear));
  for (std::size_t i = 1; i < scene.materials.size(); i += 2) {
    testbench::for_each_texture(scene.materials[i].textures, [&](TextureReference& reference) {
      if (reference) reference.texture = numbers;
    });
    testbench::MaterialTextures& textures = scene.materials[i].textures;
    if (textures.reflectance) textures.reflectance.texture = colour;
    if (textures.emission) textures.emission.texture = colour;
  }
  return scene;
}

RenderOptions options_for(Program program, bool folds) {
  RenderOptions options = test_support::render_options(program, 4);
  options.chip.poly.sram_bytes = 32768;
  options.program.folds_constant_textures = folds;
  return options;
}

class ConstantTextures : public test_support::SystemCFixture {};

TEST_F(ConstantTextures, AreFactorsToTheBit) {
  for (const bool has_textured_light : {false, true}) {
    const Scene scene = squares(has_textured_light);
    for (const Program program : {Program::segments, Program::direct, Program::full}) {
      const RenderResult factors = render_natively(scene, options_for(program, true));
      const RenderResult looked_up = render_natively(scene, options_for(program, false));
      EXPECT_EQ(factors.film.sha256(), looked_up.film.sha256()) << int(program) << has_textured_light;
      EXPECT_GT(factors.textures.constant, 6u);
      EXPECT_LT(factors.textures.constant, factors.textures.all);
      EXPECT_EQ(looked_up.textures.constant, 0u);
      EXPECT_EQ(looked_up.textures.all, factors.textures.all);
    }
  }
}

/// A square under a lamp, with this material.
Scene square_of(const Material& material, const std::vector<testbench::Texture>& textures) {
  Scene scene = test_support::plane_under_light({glm::dvec3(0.5), glm::dvec3(4.0)}, {12, 12});
  scene.textures = textures;
  scene.corners.coordinates[0].resize(scene.triangles.size());
  for (Material& of_scene : scene.materials)
    if (of_scene.emission == glm::dvec3(0.0)) of_scene = material;
  return scene;
}

/// What a program costs, and its image.
struct Cost {
  std::uint64_t cycles;
  std::uint64_t bytes;
  std::uint64_t sram;
  std::string image;
};

bool operator==(const Cost& a, const Cost& b) {
  return a.cycles == b.cycles && a.bytes == b.bytes && a.sram == b.sram && a.image == b.image;
}

TEST_F(ConstantTextures, CostWhatTheirFactorCosts) {
  const auto cost_of = [&](const Scene& scene) {
    new_context();
    const RenderResult result = render_on_chip(scene, options_for(Program::full, true));
    return Cost{result.chip->firmware_cycles, result.chip->pio.bytes_to_poly,
                std::uint64_t(result.chip->poly_sram.peak_bytes), result.film.sha256()};
  };
  Material textured{"wall", {0.9, 0.5, 0.8}};
  textured.textures.reflectance.texture = 0;
  Material plain{"wall",
                 {0.9 * path_tracer::linear_of_srgb(181.0), 0.5 * path_tracer::linear_of_srgb(90.0),
                  0.8 * path_tracer::linear_of_srgb(7.0)}};
  const Scene with_texture = square_of(textured, {texture_of({181, 90, 7}, 4, 4, TexelEncoding::srgb)});
  EXPECT_TRUE(testbench::features_of(with_texture, {}).plain());
  EXPECT_TRUE(cost_of(with_texture) == cost_of(square_of(plain, {})));
}

/// One channel may vary where another does not: each use asks for its own.
TEST_F(ConstantTextures, AreTakenChannelByChannel) {
  Material material{"leaf", glm::dvec3(0.5)};
  material.textures.reflectance.texture = 0;
  material.textures.alpha = material.textures.reflectance;
  material.textures.alpha.channel = 3;
  material.alpha_mode = AlphaMode::mask;
  const Scene hole = square_of(material, {texture_of({9, 9, 9}, 2, 2, TexelEncoding::srgb, 0)});
  const path_tracer::Features features = testbench::features_of(hole, {});
  EXPECT_FALSE(features.textures.has(TextureSlot::reflectance));
  EXPECT_TRUE(features.textures.has(TextureSlot::alpha));
  EXPECT_TRUE(features.coverage);
  const testbench::ShownMaterials shown = testbench::shown_materials(hole, {});
  EXPECT_EQ(shown.textures.all, 2u);
  EXPECT_EQ(shown.textures.constant, 1u);
}

/// Nothing passes, so nothing asks.
TEST_F(ConstantTextures, OfFullAlphaLetNothingThrough) {
  Material material{"leaf", glm::dvec3(0.5)};
  material.textures.alpha.texture = 0;
  material.textures.alpha.channel = 3;
  material.alpha_mode = AlphaMode::blend;
  const Scene scene = square_of(material, {texture_of({1, 2, 3}, 2, 2, TexelEncoding::srgb)});
  EXPECT_TRUE(testbench::features_of(scene, {}).plain());
  EXPECT_EQ(testbench::shown_materials(scene, {}).textures.constant, 1u);
}

/// glTF's base colour is the colour of what passes, too, with its texture.
TEST_F(ConstantTextures, ColourWhatPasses) {
  Material glass{"glass", {0.9, 0.8, 0.7}};
  glass.transmission = 0.6;
  glass.specular = 1.0;
  glass.transmission_colour = glass.reflectance;
  glass.textures.reflectance.texture = 0;
  const Scene scene = square_of(glass, {texture_of({181, 90, 7}, 1, 2, TexelEncoding::srgb)});
  EXPECT_FALSE(testbench::features_of(scene, {}).lobes.transmission_tint);
  for (const Program program : {Program::segments, Program::full})
    EXPECT_EQ(render_natively(scene, options_for(program, true)).film.sha256(),
              render_natively(scene, options_for(program, false)).film.sha256());
}

/// What a normal texture says depends on its triangle.
TEST_F(ConstantTextures, OfNormalsStay) {
  Material material{"wall", glm::dvec3(0.5)};
  material.textures.normal.texture = 0;
  const Scene scene = square_of(material, {texture_of({150, 128, 255}, 2, 2, TexelEncoding::linear)});
  EXPECT_TRUE(testbench::features_of(scene, {}).textures.has(TextureSlot::normal));
  EXPECT_EQ(testbench::shown_materials(scene, {}).textures.constant, 0u);
}

}  // namespace constant_textures_test
