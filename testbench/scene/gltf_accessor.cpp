#include "testbench/scene/gltf_accessor.hpp"

#include <tiny_gltf.h>

#include <cstring>

#include "testbench/system/error.hpp"

namespace testbench {
namespace {

template <class T>
T load(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

bool is_index_of(int index, std::size_t size) {
  return index >= 0 && std::size_t(index) < size;
}

}  // namespace

GltfAccessor::GltfAccessor(const std::filesystem::path& file, const tinygltf::Model& model, int index,
                           std::string where)
    : file_(file), where_(std::move(where)) {
  const auto require_index = [&](int found, std::size_t size, const char* what) {
    if (!is_index_of(found, size))
      fail(std::string(what) + " " + std::to_string(found),
           size == 0 ? "none, the file holds no " + std::string(what) : "0 to " + std::to_string(size - 1));
  };
  require_index(index, model.accessors.size(), "accessor");
  const tinygltf::Accessor& accessor = model.accessors[std::size_t(index)];
  if (accessor.sparse.isSparse) fail("a sparse accessor", "a dense one");
  require_index(accessor.bufferView, model.bufferViews.size(), "bufferView");
  const tinygltf::BufferView& view = model.bufferViews[std::size_t(accessor.bufferView)];
  require_index(view.buffer, model.buffers.size(), "buffer");
  const std::vector<unsigned char>& bytes = model.buffers[std::size_t(view.buffer)].data;

  component_type_ = accessor.componentType;
  is_vec3_ = accessor.type == TINYGLTF_TYPE_VEC3;
  is_scalar_ = accessor.type == TINYGLTF_TYPE_SCALAR;
  const int component_bytes = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component_type_));
  if ((!is_vec3_ && !is_scalar_) || component_bytes <= 0)
    fail("an unknown type", "SCALAR or VEC3 of numbers");
  const std::size_t element_bytes = std::size_t(component_bytes) * (is_vec3_ ? 3 : 1);
  stride_bytes_ = view.byteStride == 0 ? element_bytes : view.byteStride;
  size_ = accessor.count;
  if (size_ == 0) return;
  // Subtracted instead of added: any number may stand in the file.
  const auto fits = [](std::size_t offset, std::size_t length, std::size_t within) {
    return offset <= within && length <= within - offset;
  };
  const bool spans = size_ - 1 <= (view.byteLength / std::max<std::size_t>(stride_bytes_, 1));
  if (!fits(view.byteOffset, view.byteLength, bytes.size()) || !spans ||
      !fits(accessor.byteOffset, (size_ - 1) * stride_bytes_ + element_bytes, view.byteLength))
    fail(std::to_string(size_) + " elements beyond the end of the buffer of " + std::to_string(bytes.size()) +
             " bytes",
         "elements within it");
  data_ = bytes.data() + view.byteOffset + accessor.byteOffset;
}

glm::dvec3 GltfAccessor::point(std::size_t element) const {
  if (!is_vec3_ || component_type_ != TINYGLTF_COMPONENT_TYPE_FLOAT) fail("another type", "VEC3 of floats");
  const std::uint8_t* const from = data_ + element * stride_bytes_;
  return {load<float>(from), load<float>(from + 4), load<float>(from + 8)};
}

std::size_t GltfAccessor::index(std::size_t element, std::size_t limit) const {
  const std::uint8_t* const from = data_ + element * stride_bytes_;
  std::size_t value = 0;
  if (is_scalar_ && component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) {
    value = *from;
  } else if (is_scalar_ && component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) {
    value = load<std::uint16_t>(from);
  } else if (is_scalar_ && component_type_ == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT) {
    value = load<std::uint32_t>(from);
  } else {
    fail("another type", "SCALAR of unsigned integers");
  }
  if (value >= limit)
    fail("vertex " + std::to_string(value), limit == 0 ? "none" : "0 to " + std::to_string(limit - 1));
  return value;
}

void GltfAccessor::fail(const std::string& found, const std::string& allowed) const {
  throw InputError(file_.string() + ": " + where_ + ": found " + found + "; allowed: " + allowed);
}

}  // namespace testbench
