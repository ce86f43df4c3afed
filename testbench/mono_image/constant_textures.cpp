#include "testbench/mono_image/constant_textures.hpp"

#include <optional>

#include "firmware/path_tracer/records/texel_value.hpp"
#include "testbench/mono_image/texture_images.hpp"

namespace testbench {
namespace {

using path_tracer::TextureSlot;

/// The code that a channel has at all texels.
std::optional<double> constant_code(const Image& image, int channel) {
  const std::uint8_t first = code_of(image, 0, channel);
  for (std::size_t texel = 1; texel < texels_of(image); ++texel)
    if (code_of(image, texel, channel) != first) return std::nullopt;
  return double(first);
}

/// The material's field and reference of a slot with one channel.
struct Factor {
  double& field;
  TextureReference& reference;
};

/// Makes constant textures of a material factors of its fields.
class Folding {
 public:
  Folding(const Scene& scene, bool folds, TextureUses& uses) : scene_(scene), folds_(folds), uses_(uses) {}

  void fold(Material& material) {
    MaterialTextures& textures = material.textures;
    fold_reflectance(material);
    fold_colour(material, TextureSlot::emission, material.emission, textures.emission);
    fold_channel(material, TextureSlot::metallic, {material.metallic, textures.metallic});
    fold_channel(material, TextureSlot::roughness, {material.roughness, textures.roughness});
    fold_channel(material, TextureSlot::alpha, {material.alpha, textures.alpha});
    fold_channel(material, TextureSlot::transmission, {material.transmission, textures.transmission});
    uses_.all += shown_texture(material, TextureSlot::normal) ? 1 : 0;
  }

 private:
  /// The colour of what passes stays the base colour where it was.
  void fold_reflectance(Material& material) {
    const bool is_colour_of_transmission = material.transmission_colour == material.reflectance;
    fold_colour(material, TextureSlot::reflectance, material.reflectance, material.textures.reflectance);
    if (is_colour_of_transmission) material.transmission_colour = material.reflectance;
  }

  void fold_colour(const Material& material, TextureSlot slot, glm::dvec3& field,
                   TextureReference& reference) {
    if (!is_shown(material, slot)) return;
    const Image& image = image_of(reference);
    glm::dvec3 shown(0.0);
    for (int channel = 0; channel < 3; ++channel) {
      const std::optional<double> code = constant_code(image, channel);
      if (!code) return;
      shown[channel] = path_tracer::linear_of_srgb(*code);
    }
    field *= shown;
    drop(reference);
  }

  void fold_channel(const Material& material, TextureSlot slot, const Factor& factor) {
    if (!is_shown(material, slot)) return;
    const std::optional<double> code = constant_code(image_of(factor.reference), factor.reference.channel);
    if (!code) return;
    factor.field *= path_tracer::value_of_code(*code);
    drop(factor.reference);
  }

  /// Counts the texture if there is one, and returns whether it may become a factor.
  bool is_shown(const Material& material, TextureSlot slot) {
    if (!shown_texture(material, slot)) return false;
    ++uses_.all;
    return folds_;
  }
  const Image& image_of(const TextureReference& reference) const {
    return scene_.textures[std::size_t(reference.texture)].image;
  }
  void drop(TextureReference& reference) {
    reference = TextureReference();
    ++uses_.constant;
  }

  const Scene& scene_;
  bool folds_;
  TextureUses& uses_;
};

}  // namespace

ShownMaterials shown_materials(const Scene& scene, const path_tracer::ProgramConfig& config) {
  ShownMaterials shown{scene.materials, {}};
  const std::vector<bool> is_used = materials_in_use(scene.triangles, scene.materials.size());
  Folding folding(scene, config.folds_constant_textures, shown.textures);
  for (std::size_t i = 0; i < is_used.size(); ++i)
    if (is_used[i]) folding.fold(shown.materials[i]);
  return shown;
}

}  // namespace testbench
