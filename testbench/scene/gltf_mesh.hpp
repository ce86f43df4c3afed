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
  std::optional<GltfCamera> camera;  ///< the first camera among the scene's nodes
};

/// Reads a glTF 2.0 file, .gltf or .glb: all triangles of the default scene, or of all nodes without a parent
/// if the file names no default scene. A mesh appears once for each node that holds it, transformed by the
/// node. Surfaces are Lambertian: baseColorFactor is the reflectance, metalness and roughness are ignored;
/// emissiveFactor times the strength of KHR_materials_emissive_strength is the emitted radiance. Points and
/// lines have no area and are ignored.
///
/// Throws InputError (one line: file, part of the file, what was found, what is allowed) for a file that
/// cannot be read or is cut off, an index or range beyond what it points into, a node that is its own
/// ancestor or has two parents, a coordinate that is not a number of at most kMaxCoordinate, a colour out of
/// range, a texture, sparse or compressed data, an unknown required extension, or a file without triangles.
GltfFile load_gltf(const std::filesystem::path& file);

}  // namespace testbench
