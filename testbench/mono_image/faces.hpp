#pragma once

#include <cstdint>
#include <vector>

#include "testbench/scene/coincident_triangles.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// The face number of each triangle. Triangles of one plane that share an edge or coincide have the same
/// number, and so have all that such triangles connect.
std::vector<std::int32_t> number_faces(const std::vector<Triangle>& triangles,
                                       const CoincidentTriangles& coincident);
std::vector<std::int32_t> number_faces(const std::vector<Triangle>& triangles);

/// The unit normal times twice the area.
glm::dvec3 area_normal(const Triangle& triangle);

}  // namespace testbench
