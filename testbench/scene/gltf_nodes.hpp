#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "testbench/gltf/gltf_document.hpp"
#include "testbench/scene/gltf_mesh.hpp"

namespace testbench {

/// The nodes of a file: which belong to the scene, and where.
struct GltfNodes {
  std::vector<std::size_t> in_scene;   ///< a parent before its children
  std::vector<glm::dmat4> transforms;  ///< of every node, to the scene's coordinates
};

/// All nodes of the default scene, or all if the file names no scene. Throws InputError if nodes are no
/// trees, or a transform is none.
GltfNodes read_gltf_nodes(GltfDocument& document);

/// The transforms of what EXT_mesh_gpu_instancing places at a node, relative to the node; one that changes
/// nothing for a node without the extension.
std::vector<glm::dmat4> read_gltf_instances(GltfDocument& document, std::size_t node);

/// The camera of a node; std::nullopt for an orthographic one, which is noted. It looks along -z with +y up
/// (glTF 2.0, section 3.10).
std::optional<GltfCamera> read_gltf_camera(GltfDocument& document, std::size_t node,
                                           const glm::dmat4& transform);

}  // namespace testbench
