#pragma once

#include <functional>
#include <vector>

#include "testbench/scene/scene.hpp"

/// Meshes that are hard for searches for the nearest triangle, and scenes made of them.
namespace test_support {

struct NamedMesh {
  const char* name;
  std::function<std::vector<testbench::Triangle>()> make;
};
std::vector<NamedMesh> search_meshes();

/// Lights that share edges, and coplanar triangles on them that share no edge.
std::vector<testbench::Triangle> decals();

/// A scene of the triangles, of which the last three emit. As by the loader, triangles without area are
/// dropped, and those that emit come first where triangles coincide.
testbench::Scene scene_of(std::vector<testbench::Triangle> triangles);

}  // namespace test_support
