#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace testbench {

using Polygon = std::vector<glm::dvec3>;

/// The triangles of a polygon. All face the way the polygon does.
struct PolygonTriangles {
  std::vector<std::array<glm::dvec3, 3>> triangles;
  /// Of each triangle the corners of the polygon that it has; where edges cross, the corner that is nearest.
  std::vector<std::array<std::uint32_t, 3>> corners;
  bool crosses_itself = false;
  bool is_too_tangled = false;  ///< left out: it crosses itself too often (polygon_crossings.hpp)

  void clear() {
    triangles.clear();
    corners.clear();
    crosses_itself = false;
    is_too_tangled = false;
  }
};

/// Appends the triangles of a polygon to `result`; some may have no area. A convex polygon is cut
/// into a fan from its first vertex. A polygon of at most 255 vertices, of which one sees all others, is cut
/// into a fan from the first of those. Any other is projected along the axis in which it has the least extent
/// and tessellated there (GLU, sweep line); where it crosses itself, what its outline goes around is filled.
/// @param polygon 3 vertices or more, each coordinate of at most kMaxCoordinate; bent ones are allowed
/// Sets result.crosses_itself if it does and no fan covers it, and result.is_too_tangled if it has no
/// triangles therefore. Throws RunError if memory runs out.
void triangulate(const Polygon& polygon, PolygonTriangles& result);

}  // namespace testbench
