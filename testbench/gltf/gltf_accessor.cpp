#include "testbench/gltf/gltf_accessor.hpp"

#include <algorithm>
#include <cstring>

#include "testbench/gltf/gltf_schema.hpp"

namespace testbench {
namespace {

/// Elements that no byte of the file stands for, zeros, are at most this many.
constexpr std::size_t kMostZeros = std::size_t{1} << 22;

template <class T>
double load_as_number(const std::uint8_t* from) {
  T value;
  std::memcpy(&value, from, sizeof(value));
  return static_cast<double>(value);
}

double load_component(GltfComponent type, const std::uint8_t* from) {
  switch (type) {
    case GltfComponent::i8:
      return load_as_number<std::int8_t>(from);
    case GltfComponent::u8:
      return load_as_number<std::uint8_t>(from);
    case GltfComponent::i16:
      return load_as_number<std::int16_t>(from);
    case GltfComponent::u16:
      return load_as_number<std::uint16_t>(from);
    case GltfComponent::u32:
      return load_as_number<std::uint32_t>(from);
    case GltfComponent::f32:
      break;
  }
  return load_as_number<float>(from);
}

std::size_t bytes_of(GltfComponent type) {
  if (type == GltfComponent::i8 || type == GltfComponent::u8) return 1;
  return type == GltfComponent::i16 || type == GltfComponent::u16 ? 2 : 4;
}

std::size_t width_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type.compare(0, 3, "MAT") == 0) return std::size_t(type[3] - '0') * std::size_t(type[3] - '0');
  return std::size_t(type[3] - '0');
}

GltfComponent component_of(const nlohmann::json& object) {
  return static_cast<GltfComponent>(object.at("componentType").get<int>());
}

/// Elements in a buffer view, one behind the other or `stride_bytes` apart.
struct ElementRange {
  std::size_t view;
  std::size_t offset_bytes;
  std::size_t stride_bytes;  ///< 0 for one behind the other
  std::size_t count;
  std::size_t width;
  GltfComponent component;
};

/// Calls visit(index of the component, its number) for all components of the elements.
template <class Visitor>
void for_each_component(GltfDocument& document, const ElementRange& elements, const std::string& where,
                        const Visitor& visit) {
  const GltfBytes bytes = document.view(elements.view);
  const std::size_t component_bytes = bytes_of(elements.component);
  const std::size_t element_bytes = component_bytes * elements.width;
  const std::size_t stride = elements.stride_bytes == 0 ? element_bytes : elements.stride_bytes;
  if (stride < element_bytes)
    document.fail(where, "a byteStride of " + std::to_string(stride),
                  "at least the " + std::to_string(element_bytes) + " bytes of an element");
  // Subtracted and divided instead of added and multiplied: any number may stand in the file.
  if (elements.offset_bytes > bytes.size || element_bytes > bytes.size - elements.offset_bytes ||
      elements.count - 1 > (bytes.size - elements.offset_bytes - element_bytes) / stride)
    document.fail(where,
                  std::to_string(elements.count) + " elements beyond the end of bufferView " +
                      std::to_string(elements.view) + " of " + std::to_string(bytes.size) + " bytes",
                  "elements within it");
  for (std::size_t i = 0; i < elements.count; ++i)
    for (std::size_t k = 0; k < elements.width; ++k)
      visit(i * elements.width + k, load_component(elements.component, bytes.data + elements.offset_bytes +
                                                                           i * stride + k * component_bytes));
}

/// Replaces the elements that accessor.sparse names (glTF 2.0, section 3.6.2.3).
void replace_sparse(GltfDocument& document, const nlohmann::json& accessor, const std::string& where,
                    GltfNumbers& numbers) {
  const nlohmann::json& sparse = accessor.at("sparse");
  const auto count = sparse.at("count").get<std::size_t>();
  const std::size_t size = numbers.size();
  if (count > size)
    document.fail(where + ", sparse", std::to_string(count) + " elements", "at most " + std::to_string(size));
  const nlohmann::json& indices = sparse.at("indices");
  std::vector<std::size_t> places;
  for_each_component(
      document,
      {indices.at("bufferView"), size_or(indices, "byteOffset", 0), 0, count, 1, component_of(indices)},
      where + ", sparse indices", [&](std::size_t, double index) {
        if (index >= double(size) || (!places.empty() && index <= double(places.back())))
          document.fail(where + ", sparse indices", std::to_string(std::size_t(index)),
                        "rising ones, 0 to " + std::to_string(size - 1));
        places.push_back(std::size_t(index));
      });
  const nlohmann::json& values = sparse.at("values");
  for_each_component(document,
                     {values.at("bufferView"), size_or(values, "byteOffset", 0), 0, count, numbers.width,
                      component_of(accessor)},
                     where + ", sparse values", [&](std::size_t i, double value) {
                       numbers.values[places[i / numbers.width] * numbers.width + i % numbers.width] = value;
                     });
}

/// A buffer view may tell its stride beside or within its compression.
std::size_t stride_of(const GltfDocument& document, std::size_t view) {
  const nlohmann::json& source = document.element("bufferViews", view);
  const nlohmann::json* const packed = find_gltf(source, "extensions", "EXT_meshopt_compression");
  return size_or(source, "byteStride", packed == nullptr ? 0 : size_or(*packed, "byteStride", 0));
}

GltfNumbers read_numbers(GltfDocument& document, const nlohmann::json& accessor, const std::string& where) {
  const auto count = accessor.at("count").get<std::size_t>();
  GltfNumbers numbers;
  numbers.width = width_of(accessor.at("type").get<std::string>());
  if (const nlohmann::json* const view = find_gltf(accessor, "bufferView")) {
    const auto index = view->get<std::size_t>();
    for_each_component(document,
                       {index, size_or(accessor, "byteOffset", 0), stride_of(document, index), count,
                        numbers.width, component_of(accessor)},
                       where, [&](std::size_t, double value) { numbers.values.push_back(value); });
  } else {
    if (count > kMostZeros)
      document.fail(where, std::to_string(count) + " elements of zero",
                    "at most " + std::to_string(kMostZeros));
    numbers.values.assign(count * numbers.width, 0.0);
  }
  if (accessor.contains("sparse")) replace_sparse(document, accessor, where, numbers);
  return numbers;
}

std::string allowed_by(const GltfForm& form) {
  std::string text;
  for (const char* type : form.types) text += (text.empty() ? "" : " or ") + std::string(type);
  text += " of component type";
  for (const GltfComponent type : form.not_normalized) text += " " + std::to_string(int(type));
  for (const GltfComponent type : form.normalized) text += " " + std::to_string(int(type)) + " normalized";
  return text;
}

}  // namespace

void require_gltf_form(const GltfDocument& document, const nlohmann::json& accessor, const GltfForm& form,
                       const std::string& where) {
  const auto type = accessor.at("type").get<std::string>();
  const bool is_normalized = accessor.value("normalized", false);
  const auto& components = is_normalized ? form.normalized : form.not_normalized;
  const bool has_component =
      std::find(components.begin(), components.end(), component_of(accessor)) != components.end();
  const bool has_type =
      std::any_of(form.types.begin(), form.types.end(), [&](const char* one) { return type == one; });
  if (!has_component || !has_type)
    document.fail(where,
                  "an accessor of " + type + " of component type " +
                      json_in_message(accessor["componentType"]) + (is_normalized ? " normalized" : ""),
                  allowed_by(form));
}

void normalize_gltf_numbers(const nlohmann::json& accessor, GltfNumbers& numbers) {
  const GltfComponent type = component_of(accessor);
  if (!accessor.value("normalized", false) || type == GltfComponent::f32) return;
  const double largest = type == GltfComponent::i8    ? 127.0
                         : type == GltfComponent::u8  ? 255.0
                         : type == GltfComponent::i16 ? 32767.0
                                                      : 65535.0;
  for (double& value : numbers.values) value = std::max(value / largest, -1.0);
}

GltfNumbers read_gltf_accessor(GltfDocument& document, std::size_t index, const GltfForm& form,
                               const std::string& where) {
  const nlohmann::json& accessor = document.element("accessors", index);
  require_gltf_form(document, accessor, form, where);
  GltfNumbers numbers = read_numbers(document, accessor, where);
  normalize_gltf_numbers(accessor, numbers);
  return numbers;
}

std::vector<std::uint32_t> read_gltf_indices(GltfDocument& document, std::size_t accessor, std::size_t limit,
                                             const std::string& where) {
  if (const nlohmann::json* const view = find_gltf(document.element("accessors", accessor), "bufferView"))
    if (const nlohmann::json* const stride =
            find_gltf(document.element("bufferViews", view->get<std::size_t>()), "byteStride"))
      document.fail(where, "a byteStride of " + json_in_message(*stride),
                    "none, that is for attributes of vertices");
  const GltfNumbers numbers = read_gltf_accessor(
      document, accessor, {{"SCALAR"}, {}, {GltfComponent::u8, GltfComponent::u16, GltfComponent::u32}},
      where);
  std::vector<std::uint32_t> indices;
  indices.reserve(numbers.values.size());
  for (const double value : numbers.values) {
    if (value >= double(limit))
      document.fail(where, "vertex " + std::to_string(std::uint32_t(value)),
                    limit == 0 ? "none" : "0 to " + std::to_string(limit - 1));
    indices.push_back(static_cast<std::uint32_t>(value));
  }
  return indices;
}

}  // namespace testbench
