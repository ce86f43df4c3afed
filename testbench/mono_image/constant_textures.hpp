#pragma once

#include <cstdint>
#include <vector>

#include "firmware/path_tracer/program/program_config.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// Textures of the materials that triangles have, one for each field that a texture multiplies.
struct TextureUses {
  std::uint64_t all = 0;
  std::uint64_t constant = 0;  ///< that became factors
};

/// The materials of a scene as the firmware is told them.
struct ShownMaterials {
  std::vector<Material> materials;  ///< in the scene's order
  TextureUses textures;
};

/// Where a texture has the same texel all over, its filter, wrap and coordinates show nothing else. Then the
/// material's field takes its value as a factor, by the PEs' own arithmetic, and the texture is dropped: the
/// image is the same to the bit for the same features, and the scene may have fewer of them. A normal texture
/// stays, since what it says depends on the tangents of each triangle. With
/// ProgramConfig::folds_constant_textures off, materials are those of the scene.
ShownMaterials shown_materials(const Scene& scene, const path_tracer::ProgramConfig& config);

}  // namespace testbench
