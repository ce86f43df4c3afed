#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "testbench/gltf/gltf_document.hpp"

namespace testbench {

/// The extensions that a file may require.
std::vector<std::string> supported_gltf_extensions();

/// The bytes of a buffer view that EXT_meshopt_compression packs.
/// @param extension its object of that name in the buffer view, @param pointer where that stands
std::vector<std::uint8_t> decode_meshopt(const GltfDocument& document, const GltfBytes& packed,
                                         const nlohmann::json& extension, const std::string& pointer);

/// One attribute of a mesh that was decompressed: `width` numbers a vertex.
struct GltfNumbers {
  std::size_t width = 0;
  std::vector<double> values;

  std::size_t size() const { return width == 0 ? 0 : values.size() / width; }
  const double* operator[](std::size_t element) const { return values.data() + element * width; }
};

/// A primitive that KHR_draco_mesh_compression packs.
struct DracoPrimitive {
  std::map<std::string, GltfNumbers> attributes;
  std::vector<std::uint32_t> indices;  ///< three a triangle
};

/// @param extension the object KHR_draco_mesh_compression of the primitive, @param pointer where that stands
DracoPrimitive decode_draco(const GltfDocument& document, const GltfBytes& packed,
                            const nlohmann::json& extension, const std::string& pointer);

/// Whether this program was built with the library for KHR_draco_mesh_compression.
bool has_draco();

}  // namespace testbench
