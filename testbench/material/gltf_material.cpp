#include "testbench/material/gltf_material.hpp"

#include <algorithm>
#include <sstream>

#include "testbench/gltf/gltf_schema.hpp"
#include "testbench/material/gltf_texture.hpp"

namespace testbench {
namespace {

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";
constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";

/// The extensions of materials that are read.
constexpr const char* kReadExtensions[] = {
    kSpecularGlossiness,    kEmissiveStrength,         "KHR_materials_ior",   "KHR_materials_transmission",
    "KHR_materials_volume", "KHR_materials_clearcoat", "KHR_materials_sheen", "KHR_materials_specular"};

void note_other_extensions(GltfDocument& document, const nlohmann::json& source, const std::string& pointer) {
  const nlohmann::json* const extensions = find_gltf(source, "extensions");
  if (extensions == nullptr) return;
  for (const auto& [name, content] : extensions->items())
    if (std::find(std::begin(kReadExtensions), std::end(kReadExtensions), name) == std::end(kReadExtensions))
      document.note("the extension " + name + " of materials is left out", pointer);
}

/// Reads the parts of one material.
class GltfMaterialReader {
 public:
  GltfMaterialReader(GltfDocument& document, TextureStore& store, std::size_t index)
      : document_(document),
        store_(store),
        source_(document.element("materials", index)),
        pointer_("/materials/" + std::to_string(index)) {}

  Material read() {
    material_.name = source_.value("name", "");
    material_.reflectance = glm::dvec3(1.0);
    material_.specular = 1.0;
    if (const nlohmann::json* const glossy = extension(kSpecularGlossiness))
      read_specular_glossiness(*glossy);
    else if (const nlohmann::json* const metallic = find_gltf(source_, "pbrMetallicRoughness"))
      read_metallic_roughness(*metallic);
    else
      material_.metallic = 1.0;
    read_emission();
    read_reflection();
    read_transmission();
    read_coats();
    read_alpha();
    read_normal();
    note_other_extensions(document_, source_, pointer_);
    return std::move(material_);
  }

 private:
  const nlohmann::json* extension(const char* name) const { return find_gltf(source_, "extensions", name); }

  /// The three numbers of a property, or `otherwise`.
  static glm::dvec3 colour_of(const nlohmann::json& object, const char* property,
                              const glm::dvec3& otherwise) {
    const nlohmann::json* const numbers = find_gltf(object, property);
    if (numbers == nullptr) return otherwise;
    return {(*numbers)[0].get<double>(), (*numbers)[1].get<double>(), (*numbers)[2].get<double>()};
  }

  TextureReference texture(const nlohmann::json& object, const char* property, TexelEncoding encoding,
                           int channel = 0) {
    TextureReference reference = read_gltf_texture(document_, store_, find_gltf(object, property), encoding,
                                                   pointer_ + ": " + property);
    reference.channel = channel;
    return reference;
  }

  void read_base_colour(const nlohmann::json& object, const char* factor, const char* texture_name) {
    material_.reflectance = colour_of(object, factor, glm::dvec3(1.0));
    if (const nlohmann::json* const numbers = find_gltf(object, factor))
      material_.alpha = (*numbers)[3].get<double>();
    material_.textures.reflectance = texture(object, texture_name, TexelEncoding::srgb);
    material_.textures.alpha = material_.textures.reflectance;
    material_.textures.alpha.channel = 3;
  }

  void read_metallic_roughness(const nlohmann::json& metallic) {
    read_base_colour(metallic, "baseColorFactor", "baseColorTexture");
    material_.metallic = metallic.value("metallicFactor", 1.0);
    material_.roughness = metallic.value("roughnessFactor", 1.0);
    constexpr const char* kName = "metallicRoughnessTexture";
    material_.textures.roughness = texture(metallic, kName, TexelEncoding::linear, 1);
    material_.textures.metallic = texture(metallic, kName, TexelEncoding::linear, 2);
  }

  void read_specular_glossiness(const nlohmann::json& glossy) {
    read_base_colour(glossy, "diffuseFactor", "diffuseTexture");
    material_.specular_colour =
        colour_of(glossy, "specularFactor", glm::dvec3(1.0)) / kDefaultSpecularReflectance;
    material_.roughness = 1.0 - glossy.value("glossinessFactor", 1.0);
  }

  void read_emission() {
    const nlohmann::json* const given = extension("KHR_materials_emissive_strength");
    const double strength = given == nullptr ? 1.0 : given->value("emissiveStrength", 1.0);
    material_.emission = colour_of(source_, "emissiveFactor", glm::dvec3(0.0)) * strength;
    for (int channel = 0; channel < 3; ++channel) {
      if (material_.emission[channel] <= kMaxEmission) continue;
      std::ostringstream found;
      found << "an emission of " << material_.emission[channel];
      document_.fail(pointer_, found.str(), "0 to 1e30");
    }
    material_.textures.emission = texture(source_, "emissiveTexture", TexelEncoding::srgb);
  }

  void read_reflection() {
    if (const nlohmann::json* const specular = extension("KHR_materials_specular")) {
      material_.specular = specular->value("specularFactor", 1.0);
      material_.specular_colour = colour_of(*specular, "specularColorFactor", glm::dvec3(1.0));
    }
    const nlohmann::json* const given = extension("KHR_materials_ior");
    const double ior = given == nullptr ? material_.ior : given->value("ior", material_.ior);
    if (ior > 0.0 && ior < 1.0)
      document_.fail(pointer_ + "/extensions/KHR_materials_ior/ior", json_in_message((*given)["ior"]),
                     "a number from 1, or 0");
    if (ior == 0.0)
      material_.specular_colour /= kDefaultSpecularReflectance;
    else
      material_.ior = ior;
  }

  void read_transmission() {
    if (const nlohmann::json* const source = extension("KHR_materials_transmission")) {
      material_.transmission = source->value("transmissionFactor", 0.0);
      material_.transmission_colour = material_.reflectance;
      material_.textures.transmission = texture(*source, "transmissionTexture", TexelEncoding::linear);
    }
    if (const nlohmann::json* const volume = extension("KHR_materials_volume")) {
      material_.is_thin = !(volume->value("thicknessFactor", 0.0) > 0.0);
      material_.attenuation_colour = colour_of(*volume, "attenuationColor", glm::dvec3(1.0));
      material_.attenuation_distance = volume->value("attenuationDistance", material_.attenuation_distance);
    }
  }

  void read_coats() {
    if (const nlohmann::json* const coat = extension("KHR_materials_clearcoat")) {
      material_.clearcoat = coat->value("clearcoatFactor", 0.0);
      material_.clearcoat_roughness = coat->value("clearcoatRoughnessFactor", 0.0);
    }
    if (const nlohmann::json* const sheen = extension("KHR_materials_sheen")) {
      material_.sheen_colour = colour_of(*sheen, "sheenColorFactor", glm::dvec3(0.0));
      material_.sheen_roughness = sheen->value("sheenRoughnessFactor", 0.0);
    }
  }

  void read_alpha() {
    const std::string mode = source_.value("alphaMode", "OPAQUE");
    material_.alpha_mode = mode == "MASK"    ? AlphaMode::mask
                           : mode == "BLEND" ? AlphaMode::blend
                                             : AlphaMode::opaque;
    material_.alpha_cutoff = source_.value("alphaCutoff", 0.5);
    material_.is_double_sided = source_.value("doubleSided", false);
    const bool is_opaque = material_.alpha_mode == AlphaMode::opaque;
    if (is_opaque) material_.alpha = 1.0;
    TextureReference& texture = material_.textures.alpha;
    if (texture && (is_opaque || !has_alpha(store_.at(texture.texture).image))) texture = TextureReference();
  }

  void read_normal() {
    material_.textures.normal = texture(source_, "normalTexture", TexelEncoding::linear);
    if (const nlohmann::json* const normal = find_gltf(source_, "normalTexture"))
      material_.normal_scale = normal->value("scale", 1.0);
  }

  GltfDocument& document_;
  TextureStore& store_;
  const nlohmann::json& source_;
  const std::string pointer_;
  Material material_;
};

}  // namespace

Material read_gltf_material(GltfDocument& document, TextureStore& store, std::size_t index) {
  return GltfMaterialReader(document, store, index).read();
}

}  // namespace testbench
