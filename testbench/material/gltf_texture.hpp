#pragma once

#include "testbench/gltf/gltf_document.hpp"
#include "testbench/texture/texture_store.hpp"

namespace testbench {

/// Reads a textureInfo of a material, its texture, sampler and image, and KHR_texture_transform. There are no
/// smaller copies of images, so the filter is magFilter's, or else what minFilter says within one of them, or
/// else linear. Returns no texture, with a note, for one without a source that can be read and for a set of
/// texture coordinates beyond kTextureCoordinateSets.
/// @param info of the material, or nullptr: no texture
/// Throws InputError for values that break a rule of gltf_schema.hpp, and images that decode_image() refuses.
TextureReference read_gltf_texture(GltfDocument& document, TextureStore& store, const nlohmann::json* info,
                                   TexelEncoding encoding, const std::string& pointer);

}  // namespace testbench
