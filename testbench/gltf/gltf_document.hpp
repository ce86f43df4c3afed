#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "testbench/files/file_reach.hpp"
#include "testbench/system/notes.hpp"

namespace testbench {

/// Bytes that a GltfDocument holds.
struct GltfBytes {
  const std::uint8_t* data = nullptr;
  std::size_t size = 0;
};

/// A glTF file, .gltf or .glb, whose JSON has been checked (gltf_schema.hpp), and the buffers that it names,
/// which are read when they are first used. All functions throw InputError: one line with the file, the JSON
/// pointer, what was found and what is allowed.
class GltfDocument {
 public:
  GltfDocument(const std::filesystem::path& file, const FileReach& reach);

  const nlohmann::json& root() const { return root_; }
  /// A top-level array; empty if the file holds none.
  const nlohmann::json& array(const char* name) const;
  const nlohmann::json& element(const char* array_name, std::size_t index) const;
  /// Whether extensionsUsed names it.
  bool uses(const std::string& extension) const;

  /// The bytes of a buffer view, decompressed if need be.
  GltfBytes view(std::size_t index);
  /// A range of a buffer. @param pointer what asks for it, in the message
  GltfBytes range(std::size_t index, std::size_t offset, std::size_t length, const std::string& pointer);

  /// The file of an image, or the part of this file that holds it.
  std::string image_name(std::size_t index) const;
  /// The bytes of an image, encoded as PNG or JPEG: of another file, a data URI or a buffer view.
  std::string image_bytes(std::size_t index);
  /// "mesh 3 'chair'"
  std::string named(const char* array_name, const char* kind, std::size_t index) const;
  /// Checks a part that is only checked when it is used; see check_gltf().
  void check(const nlohmann::json& value, const char* object, const std::string& pointer) const;
  [[noreturn]] void fail(const std::string& pointer, const std::string& found,
                         const std::string& allowed) const;
  /// Notes that `count` parts were left out or replaced; see Notes.
  void note(const std::string& text, const std::string& pointer, std::size_t count = 1);
  const Notes& notes() const { return notes_; }

 private:
  void remember_images() const;
  std::string json_text(std::string bytes);
  void require_version() const;
  void require_supported() const;
  const std::string& buffer(std::size_t index);
  std::string uri_bytes(const nlohmann::json& uri, const std::string& pointer, const char* kind) const;
  std::string buffer_bytes(const nlohmann::json& source, std::size_t index, const std::string& pointer);
  std::string file_of_uri(const std::string& uri, const std::string& pointer) const;

  std::filesystem::path path_;
  std::string file_;
  FileReach reach_;
  nlohmann::json root_;
  std::string binary_chunk_;
  bool has_binary_chunk_ = false;
  std::map<std::size_t, std::string> buffers_;
  std::map<std::size_t, std::vector<std::uint8_t>> decompressed_;
  Notes notes_;
};

/// The index in a property, or `otherwise` if there is no such property.
inline std::size_t size_or(const nlohmann::json& object, const char* property, std::size_t otherwise) {
  const auto found = object.find(property);
  return found == object.end() ? otherwise : found->get<std::size_t>();
}

/// The member of an object by a path of names; nullptr if there is none.
template <class... Names>
const nlohmann::json* find_gltf(const nlohmann::json& object, const char* name, const Names*... more) {
  const auto found = object.find(name);
  if (found == object.end()) return nullptr;
  if constexpr (sizeof...(more) == 0)
    return &*found;
  else
    return find_gltf(*found, more...);
}

}  // namespace testbench
