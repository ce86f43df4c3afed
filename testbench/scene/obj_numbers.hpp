#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <string_view>
#include <vector>

#include "testbench/scene/scene.hpp"

// tinyobjloader reads numbers digit by digit with the installed libm's pow, so they are off by a few units in
// the last place, and it reads text that is not a number as 0. So the numbers that decide pixels are read
// here, correctly rounded and checked. tinyobjloader reads faces, indices, groups and material names.

namespace testbench {

/// The vertices (`v` lines) of an OBJ text in order. Throws InputError, which names file and line, unless
/// each line begins with three finite numbers within kMaxCoordinate.
std::vector<glm::dvec3> scan_vertices(const std::filesystem::path& file, std::string_view text);

/// The materials of an MTL text in order; Kd and Ke default to 0. Throws InputError, which names file, line
/// and material, for a colour out of range, a texture, a material without a name or defined twice, or a text
/// without materials.
std::vector<Material> scan_materials(const std::filesystem::path& file, std::string_view text);

}  // namespace testbench
