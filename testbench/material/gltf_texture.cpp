#include "testbench/material/gltf_texture.hpp"

#include "testbench/texture/image_decoder.hpp"

namespace testbench {
namespace {

// glTF 2.0, section 5.26 (sampler).
constexpr int kGltfNearest = 9728;
constexpr int kGltfNearestMipmapNearest = 9984;
constexpr int kGltfNearestMipmapLinear = 9986;
constexpr int kGltfLinear = 9729;
constexpr int kGltfRepeat = 10497;
constexpr int kGltfClampToEdge = 33071;

TextureWrap gltf_wrap_of(const nlohmann::json& sampler, const char* property) {
  const int wrap = sampler.value(property, kGltfRepeat);
  return wrap == kGltfRepeat        ? TextureWrap::repeat
         : wrap == kGltfClampToEdge ? TextureWrap::clamp_to_edge
                                    : TextureWrap::mirrored_repeat;
}

TextureFilter gltf_filter_of(const nlohmann::json& sampler) {
  const int smaller = sampler.value("minFilter", kGltfLinear);
  const int filter = sampler.value("magFilter", smaller);
  const bool is_nearest =
      filter == kGltfNearest || filter == kGltfNearestMipmapNearest || filter == kGltfNearestMipmapLinear;
  return is_nearest ? TextureFilter::nearest : TextureFilter::linear;
}

void read_gltf_sampler(const GltfDocument& document, const nlohmann::json& texture,
                       TextureReference& reference) {
  const nlohmann::json* const index = find_gltf(texture, "sampler");
  if (index == nullptr) return;
  const nlohmann::json& sampler = document.element("samplers", index->get<std::size_t>());
  document.check(sampler, "sampler", "/samplers/" + std::to_string(index->get<std::size_t>()));
  reference.wrap_u = gltf_wrap_of(sampler, "wrapS");
  reference.wrap_v = gltf_wrap_of(sampler, "wrapT");
  reference.filter = gltf_filter_of(sampler);
}

void read_gltf_transform(const nlohmann::json& info, TextureReference& reference) {
  const nlohmann::json* const source = find_gltf(info, "extensions", "KHR_texture_transform");
  if (source == nullptr) return;
  TextureTransform& transform = reference.transform;
  const auto read = [&](const char* property, glm::dvec2& to) {
    if (const nlohmann::json* const numbers = find_gltf(*source, property))
      to = {(*numbers)[0].get<double>(), (*numbers)[1].get<double>()};
  };
  read("offset", transform.offset);
  read("scale", transform.scale);
  transform.rotation_radians = source->value("rotation", 0.0);
}

std::size_t gltf_coordinate_set_of(const nlohmann::json& info) {
  const nlohmann::json* const transform = find_gltf(info, "extensions", "KHR_texture_transform");
  const std::size_t set = size_or(info, "texCoord", 0);
  return transform == nullptr ? set : size_or(*transform, "texCoord", set);
}

}  // namespace

TextureReference read_gltf_texture(GltfDocument& document, TextureStore& store, const nlohmann::json* info,
                                   TexelEncoding encoding, const std::string& pointer) {
  TextureReference reference;
  if (info == nullptr) return reference;
  const auto index = info->at("index").get<std::size_t>();
  const nlohmann::json& texture = document.element("textures", index);
  document.check(texture, "texture", "/textures/" + std::to_string(index));
  const nlohmann::json* const source = find_gltf(texture, "source");
  if (source == nullptr) {
    document.note("a texture without a PNG or JPEG image is left out", pointer);
    return reference;
  }
  const std::size_t set = gltf_coordinate_set_of(*info);
  if (set >= std::size_t(kTextureCoordinateSets)) {
    document.note("a texture of a set of coordinates beyond TEXCOORD_1 is left out", pointer);
    return reference;
  }
  read_gltf_sampler(document, texture, reference);
  read_gltf_transform(*info, reference);
  reference.coordinate_set = static_cast<std::int32_t>(set);
  const auto image = source->get<std::size_t>();
  const std::string name = document.image_name(image);
  reference.texture =
      store.index_of(name, encoding, [&] { return decode_image(document.image_bytes(image), name); });
  return reference;
}

}  // namespace testbench
