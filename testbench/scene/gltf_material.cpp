#include "testbench/scene/gltf_material.hpp"

#include <sstream>

#include "testbench/scene/mesh.hpp"

namespace testbench {
namespace {

constexpr const char* kSpecularGlossiness = "KHR_materials_pbrSpecularGlossiness";
constexpr const char* kEmissiveStrength = "KHR_materials_emissive_strength";

void note_what_is_left_out(GltfDocument& document, const nlohmann::json& source, const std::string& pointer) {
  const nlohmann::json* const metallic = find_gltf(source, "pbrMetallicRoughness");
  const nlohmann::json* const glossy = find_gltf(source, "extensions", kSpecularGlossiness);
  for (const char* texture : {"normalTexture", "occlusionTexture", "emissiveTexture"})
    if (source.contains(texture))
      document.note(std::string(texture) + " is left out, the factor alone counts", pointer);
  for (const char* texture : {"baseColorTexture", "metallicRoughnessTexture"})
    if (metallic != nullptr && metallic->contains(texture))
      document.note(std::string(texture) + " is left out, the factor alone counts", pointer);
  if (glossy != nullptr) {
    document.note("a material of specular and glossiness is shown as diffuse, by its diffuseFactor", pointer);
    if (glossy->contains("diffuseTexture"))
      document.note("diffuseTexture is left out, the factor alone counts", pointer);
  } else if (metallic != nullptr && metallic->value("metallicFactor", 1.0) > 0.0) {
    document.note("a metallic material is shown as diffuse, by its baseColorFactor", pointer);
  }
  if (source.value("alphaMode", "OPAQUE") == "BLEND")
    document.note("a transparent material (alphaMode BLEND) is shown as opaque", pointer);
  if (const nlohmann::json* const extensions = find_gltf(source, "extensions"))
    for (const auto& [name, content] : extensions->items())
      if (name != kSpecularGlossiness && name != kEmissiveStrength)
        document.note("the extension " + name + " of materials is left out", pointer);
}

}  // namespace

GltfSurface read_gltf_material(GltfDocument& document, std::size_t index) {
  const nlohmann::json& source = document.element("materials", index);
  const std::string pointer = "/materials/" + std::to_string(index);
  GltfSurface surface;
  surface.material.name = source.value("name", "");
  surface.material.reflectance = glm::dvec3(1.0);
  const nlohmann::json* colour = find_gltf(source, "extensions", kSpecularGlossiness, "diffuseFactor");
  if (find_gltf(source, "extensions", kSpecularGlossiness) == nullptr)
    colour = find_gltf(source, "pbrMetallicRoughness", "baseColorFactor");
  const nlohmann::json* const emission = find_gltf(source, "emissiveFactor");
  const nlohmann::json* const given = find_gltf(source, "extensions", kEmissiveStrength, "emissiveStrength");
  const double strength = given == nullptr ? 1.0 : given->get<double>();
  for (int channel = 0; channel < 3; ++channel) {
    const auto place = std::size_t(channel);
    if (colour != nullptr) surface.material.reflectance[channel] = (*colour)[place].get<double>();
    if (emission != nullptr) surface.material.emission[channel] = (*emission)[place].get<double>() * strength;
    if (!(surface.material.emission[channel] <= kMaxEmission)) {
      std::ostringstream found;
      found << "an emission of " << surface.material.emission[channel];
      document.fail(pointer, found.str(), "0 to 1e12");
    }
  }
  if (colour != nullptr) surface.alpha = (*colour)[3].get<double>();
  surface.is_masked = source.value("alphaMode", "OPAQUE") == "MASK";
  surface.cutoff = source.value("alphaCutoff", 0.5);
  surface.is_double_sided = source.value("doubleSided", false);
  note_what_is_left_out(document, source, pointer);
  return surface;
}

}  // namespace testbench
