#include "testbench/material/material.hpp"

namespace testbench {

bool has_texture(const Material& material) {
  bool has_one = false;
  for_each_texture(material.textures,
                   [&](const TextureReference& reference) { has_one = has_one || reference; });
  return has_one;
}

bool is_plain(const Material& material) {
  const bool has_lobe = material.metallic > 0.0 || material.specular > 0.0 || material.transmission > 0.0 ||
                        material.clearcoat > 0.0 || material.sheen_colour != glm::dvec3(0.0);
  return !has_lobe && material.alpha_mode == AlphaMode::opaque && !has_texture(material);
}

}  // namespace testbench
