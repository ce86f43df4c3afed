#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "testbench/files/file_reach.hpp"
#include "testbench/material/material.hpp"
#include "testbench/scene_file/table_reader.hpp"
#include "testbench/texture/texture_store.hpp"

namespace testbench {

/// One key of a material in scene.toml. Exactly one of the members is set, which says of what kind its value
/// is: a number, a colour, true or false, a texture, or, if none is, an alpha mode.
struct MaterialKey {
  const char* name;
  const char* meaning;
  double least = 0.0;  ///< of a number or of each channel of a colour
  double most = 1.0;
  double Material::*number = nullptr;
  glm::dvec3 Material::*colour = nullptr;
  bool Material::*flag = nullptr;
  TextureReference MaterialTextures::*texture = nullptr;
  const char* factor = nullptr;  ///< the key that a texture multiplies
};

/// All keys, in the order of docs/how-to/materials.md.
const std::vector<MaterialKey>& material_keys();

/// What a key's value may be: "a number from 0 to 1".
std::string allowed_by(const MaterialKey& key);

/// Where textures that scene.toml names come from.
struct TextureFiles {
  std::filesystem::path folder;  ///< of the scene.toml
  const FileReach& reach;
  TextureStore& store;
};

/// Reads a material's table. A key that is missing keeps Material's default, but for: the factor of a texture
/// is 1; specular is 1 if metallic, roughness, ior, transmission or their textures are there; alpha_mode is
/// "blend" if alpha or its texture is there. Without a texture of alpha, a mode takes the alpha of
/// reflectance_texture. Throws InputError for an unknown key, a value out of range, and a texture that cannot
/// be read.
Material read_toml_material(const TableReader& table, const TextureFiles& files);

}  // namespace testbench
