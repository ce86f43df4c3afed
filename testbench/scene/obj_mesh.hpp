#pragma once

#include <filesystem>

#include "testbench/scene/mesh.hpp"

namespace testbench {

/// Reads an OBJ file and the MTL files it names (relative to it). `Kd` is the reflectance, `Ke` the emitted
/// radiance. Polygons are cut into fans from their first vertex (a concave one from the first vertex that
/// sees all others). Throws InputError: unreadable file, missing MTL file or material, bad index or number,
/// Kd outside [0, 1], Ke outside [0, kMaxEmission], a texture, a polygon that no fan covers, no face at all.
Mesh load_obj_mesh(const std::filesystem::path& obj_file);

}  // namespace testbench
