#include "testbench/scene_file/toml_material.hpp"

#include <glm/trigonometric.hpp>

namespace testbench {
namespace {

constexpr double kLargestSpecularColour = 1.0 / kDefaultSpecularReflectance;

MaterialKey number_key(const char* name, double Material::*number, double least, double most,
                       const char* meaning) {
  MaterialKey key{name, meaning, least, most};
  key.number = number;
  return key;
}

MaterialKey colour_key(const char* name, glm::dvec3 Material::*colour, double most, const char* meaning) {
  MaterialKey key{name, meaning, 0.0, most};
  key.colour = colour;
  return key;
}

MaterialKey flag_key(const char* name, bool Material::*flag, const char* meaning) {
  MaterialKey key{name, meaning};
  key.flag = flag;
  return key;
}

MaterialKey texture_key(const char* name, TextureReference MaterialTextures::*texture, const char* factor,
                        const char* meaning) {
  MaterialKey key{name, meaning};
  key.texture = texture;
  key.factor = factor;
  return key;
}

std::vector<MaterialKey> make_material_keys() {
  using M = Material;
  using T = MaterialTextures;
  return {
      colour_key("reflectance", &M::reflectance, 1.0, "base colour, linear RGB"),
      colour_key("emission", &M::emission, kMaxEmission, "emitted radiance, linear RGB"),
      number_key("metallic", &M::metallic, 0.0, 1.0, "0 dielectric, 1 metal"),
      number_key("roughness", &M::roughness, 0.0, 1.0, "square root of GGX's alpha"),
      number_key("specular", &M::specular, 0.0, 1.0, "strength of a dielectric's reflection"),
      colour_key("specular_colour", &M::specular_colour, kLargestSpecularColour,
                 "its colour at normal incidence"),
      number_key("ior", &M::ior, 1.0, 100.0, "index of refraction"),
      number_key("transmission", &M::transmission, 0.0, 1.0, "share of the light that passes"),
      colour_key("transmission_colour", &M::transmission_colour, 1.0, "colour of what passes"),
      flag_key("thin", &M::is_thin, "a sheet; false: the mesh bounds a volume"),
      colour_key("attenuation_colour", &M::attenuation_colour, 1.0, "white light after the distance"),
      number_key("attenuation_distance", &M::attenuation_distance, 1e-100, 1e100,
                 "in a volume, in the scene's unit"),
      number_key("clearcoat", &M::clearcoat, 0.0, 1.0, "strength of a coat"),
      number_key("clearcoat_roughness", &M::clearcoat_roughness, 0.0, 1.0, "its roughness"),
      colour_key("sheen_colour", &M::sheen_colour, 1.0, "colour of cloth's sheen"),
      number_key("sheen_roughness", &M::sheen_roughness, 0.0, 1.0, "its roughness"),
      MaterialKey{"alpha_mode", "whether alpha counts"},
      number_key("alpha", &M::alpha, 0.0, 1.0, "coverage"),
      number_key("alpha_cutoff", &M::alpha_cutoff, 0.0, 1.0, "least alpha that \"mask\" shows"),
      flag_key("double_sided", &M::is_double_sided, "normals face the viewer"),
      number_key("normal_scale", &M::normal_scale, -100.0, 100.0, "strength of normal_texture"),
      texture_key("reflectance_texture", &T::reflectance, "reflectance", "sRGB"),
      texture_key("metallic_texture", &T::metallic, "metallic", "one channel"),
      texture_key("roughness_texture", &T::roughness, "roughness", "one channel"),
      texture_key("normal_texture", &T::normal, "normal_scale", "x, y, z in the tangent's frame"),
      texture_key("emission_texture", &T::emission, "emission", "sRGB"),
      texture_key("transmission_texture", &T::transmission, "transmission", "one channel"),
      texture_key("alpha_texture", &T::alpha, "alpha", "one channel"),
  };
}

/// "0.25", "1e30"
std::string short_text_of(double number) {
  std::ostringstream text;
  text << number;
  std::string result = text.str();
  if (const std::size_t plus = result.find('+'); plus != std::string::npos) result.erase(plus, 1);
  return result;
}

/// Reads a texture: a file's name, or a table of it and how it is looked up.
TextureReference read_toml_texture(const TableReader& material, const MaterialKey& key,
                                   const TextureFiles& files) {
  TextureReference reference;
  const bool is_colour =
      key.texture == &MaterialTextures::reflectance || key.texture == &MaterialTextures::emission;
  const auto read_file = [&](const TableReader& table, const char* file_key) {
    const std::filesystem::path file = files.folder / table.text(file_key);
    files.reach.require(file, table.where_is(file_key) + ": " + key.name);
    reference.texture =
        files.store.index_of_file(file, is_colour ? TexelEncoding::srgb : TexelEncoding::linear);
  };
  if (!material.is_table(key.name)) {
    read_file(material, key.name);
    return reference;
  }
  const TableReader table = material.table(key.name);
  table.require_only({"file", "coordinate_set", "channel", "wrap_u", "wrap_v", "filter", "offset",
                      "rotation_degrees", "scale"});
  read_file(table, "file");
  const std::vector<const char*> wraps{"repeat", "mirrored_repeat", "clamp_to_edge"};
  if (table.has("wrap_u")) reference.wrap_u = static_cast<TextureWrap>(table.choice("wrap_u", wraps));
  if (table.has("wrap_v")) reference.wrap_v = static_cast<TextureWrap>(table.choice("wrap_v", wraps));
  if (table.has("filter"))
    reference.filter = static_cast<TextureFilter>(table.choice("filter", {"nearest", "linear"}));
  if (table.has("channel"))
    reference.channel = static_cast<std::int32_t>(table.choice("channel", {"r", "g", "b", "a"}));
  if (table.has("coordinate_set"))
    reference.coordinate_set = table.whole_number("coordinate_set", 0, kTextureCoordinateSets - 1);
  if (table.has("offset")) reference.transform.offset = table.pair("offset");
  if (table.has("scale")) reference.transform.scale = table.pair("scale");
  if (table.has("rotation_degrees"))
    reference.transform.rotation_radians = glm::radians(table.number("rotation_degrees"));
  return reference;
}

void read_toml_key(const TableReader& table, const MaterialKey& key, const TextureFiles& files,
                   Material& material) {
  if (key.number != nullptr)
    material.*key.number = table.number_within(key.name, key.least, key.most, allowed_by(key));
  else if (key.colour != nullptr)
    material.*key.colour = table.colour(key.name, key.most, allowed_by(key));
  else if (key.flag != nullptr)
    material.*key.flag = table.flag(key.name);
  else if (key.texture != nullptr)
    material.textures.*key.texture = read_toml_texture(table, key, files);
  else
    material.alpha_mode = static_cast<AlphaMode>(table.choice(key.name, {"opaque", "mask", "blend"}));
}

/// Sets the factors of textures that the table does not name to 1, whatever Material's default.
void set_factors_of_textures(const TableReader& table, Material& material) {
  for (const MaterialKey& of_texture : material_keys()) {
    if (of_texture.texture == nullptr || !table.has(of_texture.name) || table.has(of_texture.factor))
      continue;
    for (const MaterialKey& factor : material_keys()) {
      if (std::string_view(factor.name) != of_texture.factor) continue;
      if (factor.number != nullptr) material.*factor.number = 1.0;
      if (factor.colour != nullptr) material.*factor.colour = glm::dvec3(1.0);
    }
  }
}

void complete_alpha(const TableReader& table, const TextureFiles& files, Material& material) {
  if (!table.has("alpha_mode") && (table.has("alpha") || table.has("alpha_texture")))
    material.alpha_mode = AlphaMode::blend;
  const TextureReference& reflectance = material.textures.reflectance;
  if (material.alpha_mode == AlphaMode::opaque || material.textures.alpha || !reflectance ||
      !has_alpha(files.store.at(reflectance.texture).image))
    return;
  material.textures.alpha = reflectance;
  material.textures.alpha.channel = 3;
}

}  // namespace

const std::vector<MaterialKey>& material_keys() {
  static const std::vector<MaterialKey> keys = make_material_keys();
  return keys;
}

std::string allowed_by(const MaterialKey& key) {
  if (key.flag != nullptr) return "true or false";
  if (key.texture != nullptr) return "a PNG or JPEG file, or a table with its file";
  if (key.number == nullptr && key.colour == nullptr) return "opaque, mask, blend";
  return (key.number != nullptr ? "a number from " : "three numbers from ") + short_text_of(key.least) +
         " to " + short_text_of(key.most);
}

Material read_toml_material(const TableReader& table, const TextureFiles& files) {
  std::vector<const char*> names;
  for (const MaterialKey& key : material_keys()) names.push_back(key.name);
  table.require_only(names);
  Material material;
  material.name = "material";
  for (const MaterialKey& key : material_keys())
    if (table.has(key.name)) read_toml_key(table, key, files, material);
  set_factors_of_textures(table, material);
  for (const char* const name : {"metallic", "roughness", "ior", "transmission", "metallic_texture",
                                 "roughness_texture", "transmission_texture"})
    if (table.has(name) && !table.has("specular")) material.specular = 1.0;
  complete_alpha(table, files, material);
  return material;
}

}  // namespace testbench
