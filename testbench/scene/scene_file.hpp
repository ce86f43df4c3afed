#pragma once

#include <filesystem>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Loads a scene. `path` is a directory that holds a scene.toml, or a .toml file itself, or a .gltf or .glb
/// file with a camera (its picture is 480 pixels high). A scene.toml:
///
///     [camera]                               optional when a mesh file holds one
///               position = [x, y, z]
///               look_at = [x, y, z]          or  direction = [x, y, z]
///               up = [x, y, z]               optional, default [0, 1, 0]
///               vertical_fov_degrees = 40    or  focal_length = 0.035 and film_height = 0.025 (same unit)
///     [film]    width, height = pixels       optional, default 480 x 480
///     [[mesh]]  file = "box.obj"             or .gltf, .glb; relative to the .toml file
///               scale = s                    optional, then rotate_degrees = [x, y, z] about the x, then the
///               y, then the translate = [x, y, z]        z axis, then translate
///
/// Throws InputError (one line: file, line, key, what was found, what is allowed), also for a scene without
/// light.
Scene load_scene(const std::filesystem::path& path);

}  // namespace testbench
