#pragma once

#include <functional>
#include <vector>

#include "testbench/scene/scene.hpp"

/// Meshes that are hard on searches for the nearest triangle, and scenes of them.
namespace test_support {

struct NamedMesh {
  const char* name;
  std::function<std::vector<testbench::Triangle>()> make;
};
std::vector<NamedMesh> search_meshes();

/// Lights that share edges, and coplanar triangles on them that share none.
std::vector<testbench::Triangle> decals();

/// The last three triangles shine; those without area are dropped, as the loader does.
testbench::Scene scene_of(std::vector<testbench::Triangle> triangles);

}  // namespace test_support
