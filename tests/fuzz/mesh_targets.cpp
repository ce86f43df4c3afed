#include <string>

#include "testbench/material/mtl_file.hpp"
#include "testbench/scene_file/scene_file.hpp"
#include "tests/fuzz/input_files.hpp"
#include "tests/fuzz/targets.hpp"

namespace fuzz {
namespace {

/// Throws what load_scene() throws. What it returns can be rendered.
void load(const char* file) {
  const testbench::Scene scene = testbench::load_scene(file);
  if (scene.triangles.empty()) fail("a scene without triangles");
  for (const testbench::Triangle& triangle : scene.triangles)
    if (triangle.material < 0 || std::size_t(triangle.material) >= scene.materials.size())
      fail("a triangle without a material");
}

}  // namespace

void read_obj(std::string_view input) {
  write_parts(input, {"mesh.obj", "materials.mtl"});
  load("mesh.obj");
}

void read_mtl(std::string_view input) {
  testbench::scan_materials("materials.mtl", input);
}

void read_ply(std::string_view input) {
  write_file("mesh.ply", input);
  load("mesh.ply");
}

void read_gltf(std::string_view input) {
  write_parts(input, {"mesh.gltf", "buffer.bin"});
  load("mesh.gltf");
}

void read_glb(std::string_view input) {
  write_file("mesh.glb", input);
  load("mesh.glb");
}

void read_scene(std::string_view input) {
  write_parts(input, {"scene.toml", "mesh.obj"});
  load(".");
}

}  // namespace fuzz
