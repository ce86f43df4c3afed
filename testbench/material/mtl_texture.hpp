#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "testbench/files/file_reach.hpp"
#include "testbench/material/material.hpp"
#include "testbench/system/notes.hpp"
#include "testbench/texture/texture_store.hpp"

namespace testbench {

/// A texture that an MTL file names. It is read when a face uses its material.
struct MtlTexture {
  TextureReference MaterialTextures::*slot = nullptr;
  TexelEncoding encoding = TexelEncoding::linear;
  bool may_be_height = false;          ///< whether a grey image is a height map, not normals
  std::string file;                    ///< as the MTL file names it
  std::string where;                   ///< file, line and keyword of the MTL file
  TextureReference reference;          ///< its options, without an image
  std::optional<int> channel;          ///< of -imfchan
  double bump_multiplier = 1.0;        ///< of -bm
  double Material::*factor = nullptr;  ///< what is 1 with the texture, because the MTL file has no number
};

/// The texture that a line of an MTL file names, behind its keyword in lower case; std::nullopt for a keyword
/// whose textures are not used, and a line that names no file. Options: -o, -s, -clamp, -imfchan and -bm; all
/// others are skipped.
std::optional<MtlTexture> parse_mtl_texture(std::string_view keyword, std::string_view line,
                                            const std::string& where);

/// Where textures of an MTL file come from.
struct MtlTextureFiles {
  std::filesystem::path folder;  ///< of the MTL file
  const FileReach& reach;
  TextureStore& store;
  bool must_exist = false;  ///< whether a missing file is an error; otherwise it is noted
};

/// Reads the textures of a material into `files.store` and `material.textures`. A height map becomes a normal
/// texture. What is missing or has one height is noted. Throws InputError for a file out of reach or one that
/// decode_image() refuses.
void load_mtl_textures(const std::vector<MtlTexture>& textures, const MtlTextureFiles& files,
                       Material& material, Notes& notes);

}  // namespace testbench
