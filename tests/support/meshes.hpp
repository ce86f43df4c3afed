#pragma once

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "firmware/path_tracer/records/node_layout.hpp"
#include "testbench/bvh/bvh.hpp"

namespace test_support {

using testbench::Triangle;

inline Triangle triangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
  return {{a, b, c}, 0};
}

/// Triangles of about `size`, scattered over a cube of `extent`.
inline std::vector<Triangle> soup(int count, double extent, double size, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  const auto point = [&](double scale) {
    return glm::dvec3(number(random), number(random), number(random)) * scale;
  };
  std::vector<Triangle> triangles;
  for (int i = 0; i < count; ++i) {
    const glm::dvec3 at = point(0.5 * extent);
    triangles.push_back(triangle(at + point(size), at + point(size), at + point(size)));
  }
  return triangles;
}

/// Meshes that are hard for builders and traversals.
enum class Mesh {
  one,
  coplanar,  ///< a flat grid along two axes
  soup,
  needles,     ///< long, thin triangles that intersect
  duplicates,  ///< copies of one triangle
  point,       ///< triangles without extent, in one place
  line,        ///< triangles without area, along one axis
  scales,      ///< a fine mesh in a coarse one, 10^5 times larger ("teapot in a stadium")
  huge,
  tiny,
};
inline constexpr Mesh kMeshes[] = {Mesh::one,   Mesh::coplanar, Mesh::soup,   Mesh::needles, Mesh::duplicates,
                                   Mesh::point, Mesh::line,     Mesh::scales, Mesh::huge,    Mesh::tiny};

inline std::string name_of(Mesh mesh) {
  constexpr const char* kNames[] = {"one",   "coplanar", "soup",   "needles", "duplicates",
                                    "point", "line",     "scales", "huge",    "tiny"};
  return kNames[std::size_t(mesh)];
}

inline std::vector<Triangle> grid(int cells) {
  std::vector<Triangle> triangles;
  for (int x = 0; x < cells; ++x)
    for (int y = 0; y < cells; ++y) {
      triangles.push_back(triangle({x, y, 1}, {x + 1, y, 1}, {x, y + 1, 1}));
      triangles.push_back(triangle({x + 1, y + 1, 1}, {x, y + 1, 1}, {x + 1, y, 1}));
    }
  return triangles;
}

inline std::vector<Triangle> needles(int count) {
  std::vector<Triangle> triangles = soup(count, 1.0, 1.0, 3);
  for (Triangle& t : triangles) t.vertex[2] = t.vertex[1] + (t.vertex[2] - t.vertex[1]) * 1e-6;
  return triangles;
}

inline std::vector<Triangle> mesh(Mesh kind) {
  switch (kind) {
    case Mesh::one:
      return {triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})};
    case Mesh::coplanar:
      return grid(12);
    case Mesh::soup:
      return soup(2000, 1.0, 0.05, 1);
    case Mesh::needles:
      return needles(500);
    case Mesh::duplicates:
      return std::vector<Triangle>(1000, triangle({1, 2, 3}, {2, 2, 3}, {1, 3, 3}));
    case Mesh::point:
      return std::vector<Triangle>(300, triangle({1, 2, 3}, {1, 2, 3}, {1, 2, 3}));
    case Mesh::line: {
      std::vector<Triangle> triangles;
      for (int i = 0; i < 300; ++i) triangles.push_back(triangle({i, 0, 0}, {i + 1, 0, 0}, {i + 2, 0, 0}));
      return triangles;
    }
    case Mesh::scales: {
      std::vector<Triangle> triangles = soup(1000, 1.0, 0.05, 5);
      for (const Triangle& t : soup(200, 1e5, 1e4, 6)) triangles.push_back(t);
      return triangles;
    }
    case Mesh::huge:
      return soup(500, 1e300, 1e299, 7);
    case Mesh::tiny:
      return soup(500, 1e-300, 1e-301, 8);
  }
  return {};
}

/// Scales triangles to the unit of a format's nodes.
inline std::vector<testbench::Triangle> in_nodes_unit(std::vector<testbench::Triangle> triangles,
                                                      path_tracer::NodeFormat format) {
  testbench::Box all;
  for (const testbench::Triangle& triangle : triangles) all.include(bounds_of(triangle));
  const glm::dvec3 size = all.upper - all.lower;
  const double unit = path_tracer::to_node_unit(format, std::max({size.x, size.y, size.z}));
  for (testbench::Triangle& triangle : triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex *= unit;
  return triangles;
}

}  // namespace test_support
