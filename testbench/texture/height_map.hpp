#pragma once

#include "testbench/texture/texture.hpp"

namespace testbench {

/// How the codes of a height map are meant.
struct HeightMap {
  int channel = 0;          ///< of the image
  double white_texels = 1;  ///< height of the largest code over code 0, in texels; may be negative
  TextureWrap wrap_u = TextureWrap::repeat;
  TextureWrap wrap_v = TextureWrap::repeat;
};

/// The normal texture of a height map: x, y and z of the normal as glTF 2.0, section 3.9.3, has them, RGB.
/// Its slopes are the central differences of neighbouring texels. Errors: a step of the codes, 1/255 of the
/// normal's length in x, y and z.
Image normals_of_heights(const Image& heights, const HeightMap& map);

}  // namespace testbench
