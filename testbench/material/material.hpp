#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <string>

#include "testbench/texture/texture.hpp"

namespace testbench {

/// The grey of faces for which no file names a material, and of materials for which it names no colour:
/// linear reflectance of all three channels, as Blender's default material.
inline constexpr double kDefaultReflectance = 0.8;
/// The largest radiance that a material may emit. Samples that are 2^20 times as bright, the largest that a
/// film takes, fit the single precision of OpenEXR files.
inline constexpr double kMaxEmission = 1e30;
/// What a dielectric of index 1.5 reflects at normal incidence.
inline constexpr double kDefaultSpecularReflectance = 0.04;

/// Whether alpha counts (glTF 2.0, section 3.9.4).
enum class AlphaMode : std::uint8_t {
  opaque,  ///< it does not
  mask,    ///< a surface is there where its alpha is at least the cutoff
  blend    ///< a surface is there with the probability alpha
};

/// The textures of a material. Each multiplies the field of Material that it is named after.
struct MaterialTextures {
  TextureReference reflectance;
  TextureReference metallic;   ///< one channel
  TextureReference roughness;  ///< one channel
  TextureReference normal;     ///< x, y, z in the tangent's frame, from -1 to 1: glTF 2.0, section 3.9.3
  TextureReference emission;
  TextureReference transmission;  ///< one channel
  TextureReference alpha;         ///< one channel
};

/// A surface in the terms of glTF 2.0 (section 3.9, appendix B) and its extensions KHR_materials_ior,
/// _transmission, _volume, _clearcoat, _sheen, _specular and _emissive_strength. The default is Lambertian.
/// It emits from its front side only, the side from which its vertices run counter-clockwise.
struct Material {
  std::string name;
  glm::dvec3 reflectance{0.0};  ///< the base colour: linear RGB, each in [0, 1]
  glm::dvec3 emission{0.0};     ///< radiance, linear RGB, not negative

  double metallic = 0.0;
  double roughness = 1.0;               ///< the square root of GGX's alpha
  double specular = 0.0;                ///< how much of a dielectric's reflection there is; 1 in glTF
  glm::dvec3 specular_colour{1.0};      ///< of that reflection at normal incidence, may be above 1
  double ior = 1.5;                     ///< index of refraction, at least 1
  double transmission = 0.0;            ///< share of the light that is not reflected and passes
  glm::dvec3 transmission_colour{1.0};  ///< of what passes: in glTF the base colour
  bool is_thin = true;                  ///< whether the surface bounds no volume: light passes straight
  glm::dvec3 attenuation_colour{1.0};   ///< of white light after the distance, if it bounds a volume
  double attenuation_distance = std::numeric_limits<double>::infinity();  ///< in the scene's unit
  double clearcoat = 0.0;
  double clearcoat_roughness = 0.0;
  glm::dvec3 sheen_colour{0.0};
  double sheen_roughness = 0.0;
  AlphaMode alpha_mode = AlphaMode::opaque;
  double alpha = 1.0;
  double alpha_cutoff = 0.5;
  bool is_double_sided = false;
  bool is_side_of_light = false;  ///< of a light of two sides, which is two sheets: alpha counts on its front
  double normal_scale = 1.0;      ///< multiplies x and y of the normal texture
  MaterialTextures textures{};
};

/// Whether all channels lie in [0, 1].
inline bool is_reflectance(const glm::dvec3& colour) {
  for (int channel = 0; channel < 3; ++channel)
    if (!(colour[channel] >= 0.0 && colour[channel] <= 1.0)) return false;
  return true;
}

/// Calls visit(texture reference) for all textures of a material, also empty ones.
template <class Textures, class Visitor>
void for_each_texture(Textures& textures, const Visitor& visit) {
  for (auto* reference : {&textures.reflectance, &textures.metallic, &textures.roughness, &textures.normal,
                          &textures.emission, &textures.transmission, &textures.alpha})
    visit(*reference);
}

/// Whether the material has a texture.
bool has_texture(const Material& material);

/// Drops textures whose factor is 0, which show nothing.
void drop_idle_textures(Material& material);

/// Whether transmission_colour takes the place of reflectance: what a fully transmissive surface does not
/// reflect passes, and nothing is diffuse there.
bool shows_transmission_colour(const Material& material);

/// Whether the material only reflects diffusely and emits, the same all over.
bool is_plain(const Material& material);

}  // namespace testbench
