#pragma once

#include "testbench/mono_image/faces.hpp"
#include "testbench/scene/mesh.hpp"

namespace test_support {

/// Half of the cross product of two edges: as long as the triangle is large, on its front.
inline glm::dvec3 area(const testbench::Triangle& triangle) {
  return 0.5 * testbench::area_normal(triangle);
}

/// Of a mesh in the plane of x and y; what faces -z counts as negative.
inline double total_area(const testbench::Mesh& mesh) {
  double sum = 0.0;
  for (const testbench::Triangle& triangle : mesh.triangles) sum += area(triangle).z;
  return sum;
}

}  // namespace test_support
