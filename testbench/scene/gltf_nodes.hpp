#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
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

/// The node whose camera is to be used: that of the name, the camera's own or its node's; without a name the
/// first perspective one, else the first orthographic one, others of which are noted. std::nullopt if there
/// is none. Throws InputError if there is none of that name.
std::optional<std::size_t> find_gltf_camera(GltfDocument& document, const GltfNodes& nodes,
                                            const std::optional<std::string>& name);

/// The camera of a node. It looks along -z with +y up (glTF 2.0, section 3.10). A node's scale changes no
/// camera's view.
GltfCamera read_gltf_camera(GltfDocument& document, std::size_t node, const glm::dmat4& transform);

}  // namespace testbench
