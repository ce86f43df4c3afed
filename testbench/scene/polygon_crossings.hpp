#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace testbench {

/// Whether a tessellator can be given the outline of a polygon: its edges cross each other at most eight
/// times an edge. Each crossing becomes a vertex, so a random polygon of 3,000 vertices would become two
/// million triangles. Outlines of more than 20,000 edges also fail if too many edges lie side by side to look
/// at each pair.
/// @param outline the vertices in a plane
bool has_few_crossings(const std::vector<glm::dvec2>& outline);

}  // namespace testbench
