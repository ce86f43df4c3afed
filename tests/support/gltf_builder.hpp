#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace test_support {

/// A glTF file under construction: JSON that tests may change at will, and the bytes of its one buffer,
/// a.bin.
struct GltfBuilder {
  nlohmann::json root{{"asset", {{"version", "2.0"}}}};
  std::string bytes;

  /// Appends an element to a top-level array; returns its index.
  std::size_t add(const char* array, nlohmann::json element) {
    root[array].push_back(std::move(element));
    return root[array].size() - 1;
  }

  std::size_t add_bytes(const std::string& content) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    const std::size_t offset = bytes.size();
    bytes += content;
    root["buffers"] = {{{"byteLength", bytes.size()}, {"uri", "a.bin"}}};
    return add("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", content.size()}});
  }

  template <class T>
  std::size_t add_view(const std::vector<T>& values) {
    return add_bytes({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)});
  }

  /// @param width numbers an element
  template <class T>
  std::size_t add_accessor(const char* type, std::size_t width, const std::vector<T>& values,
                           bool is_normalized = false) {
    nlohmann::json accessor{{"bufferView", add_view(values)},
                            {"componentType", component_type(T{})},
                            {"count", values.size() / width},
                            {"type", type}};
    if (is_normalized) accessor["normalized"] = true;
    return add("accessors", accessor);
  }

  /// A mesh of one primitive. @param attributes indices of accessors by name
  std::size_t add_mesh(nlohmann::json attributes, nlohmann::json more = nlohmann::json::object()) {
    more["attributes"] = std::move(attributes);
    return add("meshes", {{"primitives", {more}}});
  }

  /// A node of the scene.
  std::size_t add_node(nlohmann::json node) {
    const std::size_t index = add("nodes", std::move(node));
    root["scenes"][0]["nodes"].push_back(index);
    return index;
  }

  static int component_type(std::int8_t) { return 5120; }
  static int component_type(std::uint8_t) { return 5121; }
  static int component_type(std::int16_t) { return 5122; }
  static int component_type(std::uint16_t) { return 5123; }
  static int component_type(std::uint32_t) { return 5125; }
  static int component_type(float) { return 5126; }
};

/// The corners of a triangle of area 1/2 at z = 0 that faces +z.
inline const std::vector<float> kGltfCorners{0, 0, 0, 1, 0, 0, 0, 1, 0};

}  // namespace test_support
