#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "testbench/scene/scene.hpp"
#include "testbench/system/notes.hpp"

namespace testbench {

/// A material of an MTL file, and what of it the renderer leaves out.
struct MtlMaterial {
  Material material;
  Notes notes;
};

/// The materials of an MTL text in order. Keywords count in any case of letters. `Kd` is the reflectance,
/// kDefaultReflectance if it is missing, or 0 for a material with `Ke`; `Ke` is the emitted radiance. What a
/// Lambertian surface does not have (gloss, transparency, textures) and unknown keywords are noted. Ka, Ns,
/// Ni, illum and sharpness only tune what is left out anyway. Throws InputError, which names file, line and
/// material, for a colour out of range, a material defined twice, or a line before the
/// first newmtl.
std::vector<MtlMaterial> scan_materials(const std::filesystem::path& file, std::string_view text);

}  // namespace testbench
