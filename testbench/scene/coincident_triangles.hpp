#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

inline constexpr std::int32_t kNoGroup = -1;

/// Triangles that lie on others in one plane: a carpet on a floor, a light in a ceiling, walls back to back.
struct CoincidentTriangles {
  /// For each triangle the number of its group, or kNoGroup if it lies on no other. Triangles of a group are
  /// connected by overlaps (coincide(), triangle_overlap.hpp).
  std::vector<std::int32_t> group;
  std::int32_t groups = 0;
  std::size_t triangles = 0;  ///< that have a group
};

/// Finds them in a time of about n log n.
CoincidentTriangles find_coincident_triangles(const Scene& scene);
/// The same of triangles that were never moved (Scene::rounded_at).
CoincidentTriangles find_coincident_triangles(const std::vector<Triangle>& triangles);

/// If triangles of the scene coincide, notes how many, and lets those that emit come first, in their order:
/// of surfaces that are equally far along a ray and face it, the first in the scene is seen.
/// @param file names the scene in the note
void order_coincident_triangles(Scene& scene, const std::string& file);

}  // namespace testbench
