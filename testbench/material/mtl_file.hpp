#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "testbench/material/material.hpp"
#include "testbench/material/mtl_texture.hpp"
#include "testbench/system/notes.hpp"

namespace testbench {

/// A material of an MTL file, the textures that it wants, and what of it the renderer leaves out.
struct MtlMaterial {
  Material material;
  std::vector<MtlTexture> textures;
  Notes notes;
};

/// The materials of an MTL text in order. Keywords count in any case of letters. `Kd` is the reflectance,
/// kDefaultReflectance if it is missing, or 0 for a material with `Ke`; `Ke` is the emitted radiance;
/// set_mtl_surface() and parse_mtl_texture() have the rest. Noted are what pictures do not show yet (gloss,
/// transparency, textures), unknown keywords, and numbers out of range, which are left out; Ka and sharpness
/// have no meaning here. Throws InputError, which names file, line and material, for a Kd or Ke out of range,
/// a material defined twice, or a line before the first newmtl.
std::vector<MtlMaterial> scan_materials(const std::filesystem::path& file, std::string_view text);

}  // namespace testbench
