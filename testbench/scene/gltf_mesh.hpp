#pragma once

#include <filesystem>
#include <optional>

#include "testbench/scene/mesh.hpp"

namespace testbench {

/// The width of the picture to its height that a file's camera asks for.
struct GltfCamera {
  Camera camera;
  std::optional<double> aspect_ratio;
};

struct GltfFile {
  Mesh mesh;
  std::optional<GltfCamera> camera;  ///< the first that the scene's nodes hold
};

/// Reads a glTF 2.0 file, .gltf or .glb: all triangles of the default scene (of all nodes without a parent,
/// if it names none), each mesh as often as nodes hold it, moved by them. Surfaces are Lambertian:
/// baseColorFactor is the reflectance, metalness and roughness are left out; emissiveFactor times the
/// strength of KHR_materials_emissive_strength is the emitted radiance. Points and lines have no area and are
/// left out.
///
/// Throws InputError (one line: file, what in it, what was found, what is allowed): a file that cannot be
/// read or is cut off, an index or range beyond what it points into, a node that is its own ancestor or has
/// two parents, a coordinate that is no number of at most kMaxCoordinate, a colour out of range, a texture,
/// sparse or compressed data, a required extension that is not known, no triangle at all.
GltfFile load_gltf(const std::filesystem::path& file);

}  // namespace testbench
