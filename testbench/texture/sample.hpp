#pragma once

#include <glm/glm.hpp>

#include "testbench/texture/texture.hpp"

// What textures show, in plain C++: the reference that a faster way to look them up is tested against.

namespace testbench {

/// Where in the image a texture coordinate lies: glTF's extension KHR_texture_transform, in which the image's
/// v grows downwards and a positive angle turns counter-clockwise.
glm::dvec2 transformed(const TextureTransform& transform, const glm::dvec2& coordinates);

/// The index of the texel that stands at place `index` of an endless row, of which the image's `size` texels
/// are 0 to size - 1. @param index a whole number, of any size
int wrapped_index(double index, int size, TextureWrap wrap);

/// A linear value in [0, 1] of a code of the sRGB transfer curve (IEC 61966-2-1).
double linear_of_srgb(std::uint8_t code);

/// One texel: linear RGB and alpha in [0, 1]; RGB are equal for grey images, alpha is 1 without one.
glm::dvec4 texel_at(const Texture& texture, int x, int y);

/// What the texture shows at a texture coordinate, as texel_at(). Texels are decoded before they are
/// filtered, and each texel that a filter touches is wrapped by itself. Coordinates that are not finite count
/// as 0. Errors: rounding, a few 1e-16.
glm::dvec4 sample_texture(const Texture& texture, const TextureReference& reference,
                          const glm::dvec2& coordinates);

}  // namespace testbench
