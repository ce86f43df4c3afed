#pragma once

#include <array>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "testbench/gltf/gltf_document.hpp"
#include "testbench/texture/texture.hpp"

namespace testbench {

/// The joints that move a vertex, and how much each counts.
struct GltfInfluence {
  std::size_t joint;
  double weight;
};

/// The triangles of a primitive, in its mesh's coordinates.
struct GltfPrimitive {
  std::vector<glm::dvec3> positions;  ///< of vertices, morph targets at their weights
  std::vector<glm::dvec4> colours;    ///< of vertices, linear RGB and alpha; may be empty
  std::vector<glm::dvec3> normals;    ///< the same, of any length; may be empty
  std::array<std::vector<glm::dvec2>, kTextureCoordinateSets> coordinates;  ///< of textures; may be empty
  std::vector<glm::dvec4> tangents;  ///< of vertices with normals, and their side; may be empty
  std::vector<std::vector<GltfInfluence>> influences;  ///< of vertices; empty unless joints were asked for
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

/// What of a primitive is wanted.
struct GltfPrimitivePlace {
  std::size_t mesh;
  std::size_t primitive;
  std::vector<double> weights;      ///< of the mesh's morph targets
  std::size_t joints;               ///< of the skin; 0 for none
  bool is_textured = false;         ///< whether texture coordinates are wanted
  bool has_normal_texture = false;  ///< whether tangents are wanted
};

/// Reads a primitive of triangles, a strip or a fan; std::nullopt for points and lines, which are noted.
std::optional<GltfPrimitive> read_gltf_primitive(GltfDocument& document, const GltfPrimitivePlace& place);

}  // namespace testbench
