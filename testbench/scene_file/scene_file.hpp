#pragma once

#include <filesystem>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Loads a scene. `path` is a directory that holds a scene.toml, or a .toml file itself, or a mesh
/// file, .obj, .ply, .gltf or .glb (in any case of letters; its picture is 480 pixels high). A mesh file
/// without a camera gets one that sees all of it (framing_camera()). Any scene in which nothing emits gets a
/// light (add_default_light()). A scene.toml:
///
///     [camera]                               optional when a mesh file holds one
///               position = [x, y, z]
///               look_at = [x, y, z]          or  direction = [x, y, z]
///               up = [x, y, z]               optional, default [0, 1, 0]
///               vertical_fov_degrees = 40    or  focal_length = 0.035 and film_height = 0.025 (same unit)
///                                            or  orthographic_height = 3, of the film in the scene's unit:
///                                                parallel rays
///     [film]    width, height = pixels       optional, default 480 x 480
///     [[mesh]]  file = "box.obj"             or .ply, .gltf, .glb; relative to the .toml file
///               material = {reflectance = [r, g, b], ...}    optional, of faces for which an OBJ or PLY
///                                            file has none; reflectance 0.8 without this key, 0 if it is
///                                            missing in it; material_keys() has all keys
///               camera = "name"              optional, of a glTF file: which of its cameras lends itself
///               scale = s                    optional, then rotate_degrees = [x, y, z] about the x, then the
///               y, then the translate = [x, y, z]        z axis, then translate
///     [environment], [[light]]               optional, see read_toml_lights()
///
/// Triangles without area and triangles that repeat another one are left out. What was left out or replaced
/// is in the scene's notes.
///
/// @param is_outside_allowed whether the scene may read files that do not lie below its own folder
/// Throws InputError (one line: file, line, key, what was found, what is allowed).
Scene load_scene(const std::filesystem::path& path, bool is_outside_allowed = false);

}  // namespace testbench
