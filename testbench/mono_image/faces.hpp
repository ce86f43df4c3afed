#pragma once

#include <cstdint>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// A number for each triangle; triangles that touch along an edge in one plane share it.
std::vector<std::int32_t> number_faces(const std::vector<Triangle>& triangles);

/// Twice the area times the unit normal.
glm::dvec3 area_normal(const Triangle& triangle);

}  // namespace testbench
