#pragma once

#include <glm/glm.hpp>

#include "testbench/gltf/gltf_document.hpp"
#include "testbench/material/light.hpp"

namespace testbench {

/// The light of a node (KHR_lights_punctual): it shines along the node's -z, its intensity is color times
/// intensity whatever the node's scale, and a range is left out with a note. Throws InputError for a light
/// that the file does not hold or that breaks a rule of gltf_schema.hpp, a position beyond kMaxCoordinate, a
/// transform without volume, and an inner cone that is no smaller than the outer one.
/// @param transform of the node to the scene's coordinates
Light read_gltf_light(GltfDocument& document, std::size_t node, const glm::dmat4& transform);

}  // namespace testbench
