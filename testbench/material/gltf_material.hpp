#pragma once

#include "testbench/gltf/gltf_document.hpp"
#include "testbench/material/material.hpp"
#include "testbench/texture/texture_store.hpp"

namespace testbench {

/// Reads a material of glTF 2.0 with its extensions KHR_materials_clearcoat, _emissive_strength, _ior,
/// _sheen, _specular, _transmission and _volume; their textures are left out but for transmission's. A
/// material of KHR_materials_pbrSpecularGlossiness becomes a dielectric whose reflection at normal incidence
/// is specularFactor, of roughness 1 - glossinessFactor. An ior of 0, which reflects all, becomes that of 1.5
/// with a specular colour of 1 / 0.04. What alphaMode OPAQUE ignores is not read. Notes what pictures do not
/// show yet. Throws InputError for an emission above kMaxEmission and an ior between 0 and 1; see
/// read_gltf_texture() for textures, which go into `store`.
Material read_gltf_material(GltfDocument& document, TextureStore& store, std::size_t index);

}  // namespace testbench
