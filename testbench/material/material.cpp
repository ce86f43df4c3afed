#include "testbench/material/material.hpp"

namespace testbench {

bool has_texture(const Material& material) {
  bool has_one = false;
  for_each_texture(material.textures,
                   [&](const TextureReference& reference) { has_one = has_one || reference; });
  return has_one;
}

void drop_idle_textures(Material& material) {
  MaterialTextures& textures = material.textures;
  const auto drop_unless = [](bool has_effect, TextureReference& reference) {
    if (!has_effect) reference = TextureReference();
  };
  drop_unless(material.reflectance != glm::dvec3(0.0), textures.reflectance);
  drop_unless(material.metallic > 0.0, textures.metallic);
  drop_unless(material.roughness > 0.0, textures.roughness);
  drop_unless(material.normal_scale != 0.0, textures.normal);
  drop_unless(material.emission != glm::dvec3(0.0), textures.emission);
  drop_unless(material.transmission > 0.0, textures.transmission);
  drop_unless(material.alpha > 0.0, textures.alpha);
}

bool shows_transmission_colour(const Material& material) {
  return material.transmission == 1.0 && !material.textures.transmission && material.metallic == 0.0;
}

bool is_plain(const Material& material) {
  const bool has_lobe = material.metallic > 0.0 || material.specular > 0.0 || material.transmission > 0.0 ||
                        material.clearcoat > 0.0 || material.sheen_colour != glm::dvec3(0.0);
  return !has_lobe && material.alpha_mode == AlphaMode::opaque && !has_texture(material);
}

}  // namespace testbench
