#pragma once

#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>

namespace tinygltf {
class Model;
}

namespace testbench {

/// Reads the elements of one accessor of a glTF file; every access is checked to lie within its buffer.
/// Throws InputError, which names `where` in the file, for an accessor that reaches beyond its buffer, is
/// sparse, or has another type than the one asked for.
class GltfAccessor {
 public:
  GltfAccessor(const std::filesystem::path& file, const tinygltf::Model& model, int index, std::string where);

  std::size_t size() const { return size_; }
  /// An element of three floats.
  glm::dvec3 point(std::size_t element) const;
  /// An element that is an unsigned integer below `limit`.
  std::size_t index(std::size_t element, std::size_t limit) const;

 private:
  [[noreturn]] void fail(const std::string& found, const std::string& allowed) const;

  const std::filesystem::path& file_;
  std::string where_;
  const std::uint8_t* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t stride_bytes_ = 0;
  int component_type_ = 0;
  bool is_vec3_ = false;
  bool is_scalar_ = false;
};

}  // namespace testbench
