#pragma once

#include <cstdint>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The face number of each triangle. Triangles that share an edge and lie in one plane have the same number.
std::vector<std::int32_t> number_faces(const std::vector<Triangle>& triangles);

/// The unit normal times twice the area.
glm::dvec3 area_normal(const Triangle& triangle);

}  // namespace testbench
