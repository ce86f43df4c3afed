#pragma once

#include <filesystem>
#include <optional>

#include "testbench/scene/mesh.hpp"

namespace testbench {

/// A camera of a glTF file, and the ratio of width to height that it asks for.
struct GltfCamera {
  Camera camera;
  std::optional<double> aspect_ratio;
};

struct GltfFile {
  Mesh mesh;
  /// The camera that is asked for by name; else the first perspective one among the scene's nodes; else the
  /// first orthographic one.
  std::optional<GltfCamera> camera;
};

/// Reads a glTF 2.0 file, .gltf or .glb: all triangles of the default scene, or of all nodes without a parent
/// if the file names no scene. A mesh appears once for each node that holds it and for each instance there,
/// transformed by the node, or by the joints of its skin as the nodes stand; morph targets count at their
/// weights. Surfaces are Lambertian (gltf_material.hpp); vertex colours multiply the reflectance by their
/// average over the triangle. Triangles of alphaMode MASK below the cutoff are left out. A double-sided
/// material that emits does so from both sides. The mesh's notes say what else the file holds.
///
/// Throws InputError (one line: file, JSON pointer or part of the file, what was found, what is allowed) for
/// a file that cannot be read, is cut off or lies out of reach, JSON that breaks a rule of gltf_schema.hpp or
/// nests too deep, an index or range beyond what it points into, nodes that are no trees, a coordinate that
/// is not a number of at most kMaxCoordinate, an unknown required extension, no triangles, or no
/// camera of the name that is asked for.
GltfFile load_gltf(const std::filesystem::path& file, const MeshOptions& options);

}  // namespace testbench
