#pragma once

#include <cstddef>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The triangles of one file. `materials` holds only the materials its triangles use, in the file's order.
struct Mesh {
  std::vector<Material> materials;
  std::vector<Triangle> triangles;
  std::size_t degenerate_triangles = 0;  ///< dropped for having no area; see is_degenerate()
};

/// The largest |coordinate| a mesh may hold: its cube is still a finite double.
inline constexpr double kMaxCoordinate = 1e100;
/// The largest radiance a material may emit: what a Film can hold.
inline constexpr double kMaxEmission = 1e12;

/// True for a triangle with no area to double precision: its height is less than 1e-12 of its longest edge.
bool is_degenerate(const Triangle& triangle);

/// Whether all coordinates are numbers of at most kMaxCoordinate.
bool is_in_range(const Triangle& triangle);

/// Gives `mesh`, whose triangles index into `all`, the materials that they use.
void keep_used_materials(const std::vector<Material>& all, Mesh& mesh);

}  // namespace testbench
