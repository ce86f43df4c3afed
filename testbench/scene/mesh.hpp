#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The triangles of one file. `materials` holds only the materials that its triangles use, in the file's
/// order.
struct Mesh {
  std::vector<Material> materials;
  std::vector<Triangle> triangles;
  std::size_t degenerate_triangles =
      0;  ///< number of triangles dropped because they have no area; see is_degenerate()
  std::vector<std::filesystem::path> files;  ///< that the loader read or that these name
};

/// The largest |coordinate| that a mesh may have: its cube is still a finite double.
inline constexpr double kMaxCoordinate = 1e100;
/// The largest radiance that a material may emit: the largest that a Film can hold.
inline constexpr double kMaxEmission = 1e12;

/// Whether a triangle has no area in double precision: its height is less than 1e-12 of its longest edge.
bool is_degenerate(const Triangle& triangle);

/// Whether all coordinates are numbers whose absolute value is at most kMaxCoordinate.
bool is_in_range(const Triangle& triangle);

/// Sets the materials of `mesh` to those of `all` that its triangles use, and renumbers the triangles'
/// indices into `all` accordingly.
void keep_used_materials(const std::vector<Material>& all, Mesh& mesh);

}  // namespace testbench
