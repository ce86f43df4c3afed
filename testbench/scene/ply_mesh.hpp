#pragma once

#include <filesystem>

#include "testbench/scene/mesh.hpp"

namespace testbench {

/// Reads a PLY file of version 1.0, ASCII or binary of either byte order: `x`, `y`, `z` of its element
/// `vertex`, and the list `vertex_indices` (or `vertex_index`) of its element `face`; see triangulate().
/// Faces have their own colour (`red`, `green`, `blue`) or else the average of their vertices' as
/// reflectance, taken as linear, integers relative to the largest of their type; without colours the material
/// of `options` or the default one (kDefaultReflectance). Vertices may have normals (`nx`, `ny`, `nz`, see
/// corner_normals()) and, for a material of `options` with textures, texture coordinates (`s`, `t` or `u`,
/// `v` or `texture_u`, `texture_v`, v growing upwards). All other properties and elements are skipped.
///
/// Throws InputError (file and line, or file and number of the element) for an unreadable file or one that
/// ends too early, a coordinate that is no number of at most kMaxCoordinate, a colour out of range, a bad
/// index, or a file without triangles.
Mesh load_ply_mesh(const std::filesystem::path& file, const MeshOptions& options);

}  // namespace testbench
