#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>

#include "testbench/texture/image.hpp"

// Textures in the terms of glTF 2.0, sections 3.8 and 3.9.2.

namespace testbench {

/// How a texel's RGB is stored. Alpha is always linear.
enum class TexelEncoding : std::uint8_t { linear, srgb };

struct Texture {
  std::string name;  ///< the file or the part of a file that it comes from
  TexelEncoding encoding = TexelEncoding::linear;
  Image image;
};

/// What stands beyond the edge of an image.
enum class TextureWrap : std::uint8_t { repeat, mirrored_repeat, clamp_to_edge };

/// How texels become a value. There are no smaller copies of an image (mipmaps).
enum class TextureFilter : std::uint8_t { nearest, linear };

/// Where in the image a texture coordinate lies (KHR_texture_transform): scaled, then rotated
/// counter-clockwise, then moved.
struct TextureTransform {
  glm::dvec2 offset{0.0};
  double rotation_radians = 0.0;
  glm::dvec2 scale{1.0};
};

inline constexpr std::int32_t kNoTexture = -1;
/// The sets of texture coordinates that a vertex may have.
inline constexpr std::int32_t kTextureCoordinateSets = 2;

/// One use of a texture by a material. Texture coordinates (0, 0) are the upper left corner of the image,
/// (1, 1) the lower right one.
struct TextureReference {
  std::int32_t texture = kNoTexture;  ///< index into Scene::textures
  std::int32_t coordinate_set = 0;    ///< below kTextureCoordinateSets
  std::int32_t channel = 0;           ///< 0 to 3 for R, G, B, alpha: the one that a single number comes from
  TextureWrap wrap_u = TextureWrap::repeat;
  TextureWrap wrap_v = TextureWrap::repeat;
  TextureFilter filter = TextureFilter::linear;
  TextureTransform transform;

  explicit operator bool() const { return texture != kNoTexture; }
};

}  // namespace testbench
