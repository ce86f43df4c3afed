#pragma once

#include <filesystem>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Writes a scene that load_scene() reads back to the last bit: scene.toml, mesh.obj and mesh.mtl in
/// `directory`, which is made if it is not there. scene.toml comes last, so that one that is there is whole.
/// Throws InputError when the directory cannot be written, RunError when writing fails.
void save_scene(const Scene& scene, const std::filesystem::path& directory);

}  // namespace testbench
