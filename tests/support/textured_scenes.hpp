#pragma once

#include <array>
#include <random>

#include "testbench/scene/scene.hpp"

/// Scenes with textures.
namespace test_support {

/// A texture of random texels.
inline testbench::Texture random_texture(int width, int height, int channels,
                                         testbench::TexelEncoding encoding) {
  testbench::Texture texture{"random", encoding, {width, height, channels, {}}};
  std::mt19937 random(static_cast<unsigned>(width * 100 + height));
  texture.image.texels.resize(std::size_t(width) * std::size_t(height) * std::size_t(channels));
  for (std::uint8_t& code : texture.image.texels) code = std::uint8_t(random());
  return texture;
}

/// Adds two triangles with texture coordinates in set 0, counter-clockwise as seen from the front; (0, 0) is
/// at the last corner.
inline void add_textured_square(testbench::Scene& scene, const std::array<glm::dvec3, 4>& corners,
                                std::int32_t material) {
  const glm::dvec2 place[4] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  for (const auto& [b, c] : {std::pair{1, 2}, std::pair{2, 3}}) {
    scene.triangles.push_back({{corners[0], corners[std::size_t(b)], corners[std::size_t(c)]}, material});
    scene.corners.coordinates[0].push_back({place[0], place[b], place[c]});
  }
}

/// A square whose reflectance is a texture with a texel for each pixel of the film, which it fills, under a
/// sky of radiance 1.
inline testbench::Scene textured_square(testbench::FilmSize film, testbench::TextureFilter filter) {
  testbench::Scene scene;
  scene.name = "textured square";
  scene.film = film;
  const double half_width = double(film.width) / film.height;
  scene.camera.position = {0, 0, 5};
  scene.camera.direction = {0, 0, -1};
  scene.camera.orthographic_height = 2.0;
  scene.textures.push_back(random_texture(film.width, film.height, 3, testbench::TexelEncoding::srgb));
  scene.materials.push_back({"textured", glm::dvec3(1.0)});
  scene.materials[0].textures.reflectance.texture = 0;
  scene.materials[0].textures.reflectance.filter = filter;
  add_textured_square(
      scene, {{{-half_width, -1, 0}, {half_width, -1, 0}, {half_width, 1, 0}, {-half_width, 1, 0}}}, 0);
  scene.environment.constant = glm::dvec3(1.0);
  return scene;
}

/// Leaning squares with textures in every slot, wrapped and filtered in every way, under a sky and a light.
inline testbench::Scene textured_squares(testbench::FilmSize film, bool has_textured_light = false) {
  using testbench::TexelEncoding;
  using testbench::TextureWrap;
  testbench::Scene scene = textured_square(film, testbench::TextureFilter::linear);
  scene.name = "textured squares";
  scene.textures.push_back(random_texture(5, 3, 4, TexelEncoding::srgb));
  scene.textures.push_back(random_texture(4, 7, 3, TexelEncoding::linear));
  scene.textures.push_back(random_texture(1, 2, 1, TexelEncoding::linear));
  constexpr TextureWrap kWraps[] = {TextureWrap::repeat, TextureWrap::mirrored_repeat,
                                    TextureWrap::clamp_to_edge};
  for (int i = 0; i < 6; ++i) {
    testbench::Material material{"square", {0.9, 0.7, 0.5}};
    material.specular = i % 2;
    material.metallic = i > 3 ? 0.6 : 1.0;
    material.roughness = 1.0;
    if (i > 3) material.transmission = 0.9;
    testbench::MaterialTextures& textures = material.textures;
    if (i != 2) textures.reflectance.texture = 1;
    if (i != 1) textures.metallic.texture = 2;
    textures.roughness.texture = i % 2 == 0 ? 2 : 3;
    if (i == 5) textures.transmission.texture = 3;
    textures.metallic.channel = 2;
    textures.roughness.channel = i % 2 == 0 ? 1 : 0;
    testbench::for_each_texture(textures, [&](testbench::TextureReference& reference) {
      reference.wrap_u = kWraps[i % 3];
      reference.wrap_v = kWraps[(i + 1) % 3];
      reference.filter = i < 2 ? testbench::TextureFilter::nearest : testbench::TextureFilter::linear;
      reference.transform = {{0.3, -2.1}, 0.4 * i, {2.5, -1.5}};
    });
    scene.materials.push_back(material);
    const double z = 0.2 + 0.3 * i;
    const double x = -1.0 + 0.35 * i;
    add_textured_square(
        scene, {{{x, -0.8, z}, {x + 0.6, -0.7, z + 0.3}, {x + 0.6, 0.7, z + 0.2}, {x, 0.8, z - 0.1}}}, i + 1);
  }
  scene.materials.push_back({"light", glm::dvec3(0.0), glm::dvec3(3.0)});
  if (has_textured_light) scene.materials.back().textures.emission.texture = 1;
  add_textured_square(scene, {{{-1, 2, 3}, {-1, 2, 0}, {1, 2, 0}, {1, 2, 3}}}, 7);
  return scene;
}

}  // namespace test_support
