#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The triangles of one OBJ file. `materials` holds only the materials its triangles use, in the order of the
/// MTL file.
struct ObjMesh {
  std::vector<Material> materials;
  std::vector<Triangle> triangles;
  std::size_t degenerate_triangles = 0;  ///< dropped for having no area; see is_degenerate()
};

/// The largest |coordinate| a mesh may hold: its cube is still a finite double.
inline constexpr double kMaxCoordinate = 1e100;
/// The largest radiance a material may emit: what a Film can hold.
inline constexpr double kMaxEmission = 1e12;

/// Reads an OBJ file and the MTL files it names (relative to it). `Kd` is the reflectance, `Ke` the emitted
/// radiance. Polygons are cut into fans from their first vertex (a concave one from the first vertex that
/// sees all others). Throws InputError: unreadable file, missing MTL file or material, bad index or number,
/// Kd outside [0, 1], Ke outside [0, kMaxEmission], a texture, a polygon that no fan covers, no face at all.
ObjMesh load_obj_mesh(const std::filesystem::path& obj_file);

/// True for a triangle with no area to double precision: its height is less than 1e-12 of its longest edge.
bool is_degenerate(const Triangle& triangle);

}  // namespace testbench
