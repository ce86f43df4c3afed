#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "testbench/scene/scene.hpp"

// tinyobjloader reads a number digit by digit (a few units in the last place off, with the installed libm's
// pow) and turns what it cannot read into 0. The numbers that decide pixels are therefore read here,
// correctly rounded and checked; tinyobjloader keeps what it does well: faces, indices, groups, material
// names.

namespace testbench {

/// The vertices (`v` lines) of an OBJ text in order. Throws InputError naming file and line for anything but
/// three finite numbers within kMaxCoordinate at the start of the line.
std::vector<glm::dvec3> scan_vertices(const std::filesystem::path& file, std::string_view text);

/// The materials of an MTL text in order; Kd and Ke default to 0. Throws InputError naming file, line and
/// material for a colour out of range, a texture, a material without a name or defined twice, or no material
/// at all.
std::vector<Material> scan_materials(const std::filesystem::path& file, std::string_view text);

}  // namespace testbench
