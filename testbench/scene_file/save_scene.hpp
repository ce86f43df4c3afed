#pragma once

#include <filesystem>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// What save_scene() writes.
inline constexpr const char* kSavedSceneFiles[] = {"mesh.mtl", "mesh.obj", "scene.toml"};

/// Writes a scene whose triangles, reflectances, emissions and camera load_scene() reads back to the last
/// bit: scene.toml, mesh.obj and mesh.mtl in `directory`, which is created if it is missing. All three or
/// none are written. Returns notes of what is left out: all else of materials, textures, normals, lights that
/// are no triangles. Throws InputError when the directory cannot be created, RunError when writing fails.
Notes save_scene(const Scene& scene, const std::filesystem::path& directory);

}  // namespace testbench
