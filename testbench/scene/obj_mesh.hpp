#pragma once

#include <filesystem>

#include "testbench/scene/mesh.hpp"

namespace testbench {

/// Reads an OBJ file and the MTL files that it names (relative to it; see scan_materials()).
///
/// Faces have any number of corners, see triangulate(). Normals are kept (corner_normals()), texture
/// coordinates for materials with textures; a face has none of them unless each of its corners has. Smoothing
/// groups are not looked at: a face without normals is flat. A face without a material, or with one that no
/// MTL file defines, has the average colour of its vertices (`v x y z r g b`, taken as linear reflectance) if
/// all have one, otherwise the material of `options`, otherwise the default one (kDefaultReflectance). Noted
/// as left out are points, lines, curves and surfaces, missing MTL files, vertex colours of faces that have a
/// material, and what the materials in use leave out.
///
/// A name of a file or a material is the rest of its line; blanks in it are allowed. If no such file exists,
/// the words of `mtllib` are each a file. A backslash in a file's name may stand for a slash.
///
/// Throws InputError for an unreadable file, a file out of reach, a bad index or number, a bad MTL file, or a
/// file without triangles.
Mesh load_obj_mesh(const std::filesystem::path& obj_file, const MeshOptions& options);

/// The same with the files that lie below the OBJ file's folder.
Mesh load_obj_mesh(const std::filesystem::path& obj_file);

}  // namespace testbench
