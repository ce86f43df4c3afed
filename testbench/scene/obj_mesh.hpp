#pragma once

#include <filesystem>

#include "testbench/scene/mesh.hpp"

namespace testbench {

/// Reads an OBJ file and the MTL files that it names (relative to it). `Kd` is the reflectance, `Ke` the
/// emitted radiance. Polygons are cut into fans from their first vertex, concave ones from the first vertex
/// that sees all others. Throws InputError for an unreadable file, a missing MTL file or material, a bad
/// index or number, Kd outside [0, 1], Ke outside [0, kMaxEmission], a texture, a polygon that no fan covers,
/// or a file without faces.
Mesh load_obj_mesh(const std::filesystem::path& obj_file);

}  // namespace testbench
