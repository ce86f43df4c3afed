#pragma once

/// What a scene needs of the path tracer. The firmware is built for its scene: the host derives the features
/// before the run, and what is absent costs no instruction, no byte of a transfer, no SRAM and no random
/// number.
namespace path_tracer {

/// The lobes that the materials of a scene have. Mono: a program is built for the scene, so a lobe that no
/// material has costs no instruction. materials/lobe_table.hpp describes each.
struct Lobes {
  bool diffuse = false;
  bool glossy = false;
  bool mirror = false;
  bool glass = false;
  bool rough_glass = false;
  bool thin_glass = false;
  bool coat = false;
  bool sheen = false;
  bool absorption = false;
  bool varnish_tint = false;
  bool transmission_tint = false;

  constexpr bool rough_specular() const { return glossy || rough_glass; }
  constexpr bool smooth_specular() const { return mirror || glass; }
  constexpr bool specular() const { return rough_specular() || smooth_specular(); }
  constexpr bool transmissive() const { return glass || rough_glass; }
  constexpr bool frosted_sheets() const { return thin_glass && rough_glass; }
  /// Lobes that are sampled by the cosine: diffuse reflection, and light that rough metal or a frosted sheet
  /// scatters more than once.
  constexpr bool cosine() const { return diffuse || glossy || frosted_sheets(); }
  constexpr int ways_to_sample() const { return int(specular()) + int(cosine()) + int(coat) + int(sheen); }
  constexpr bool only_diffuse() const { return diffuse && !specular() && !coat && !sheen; }
  /// Lobes that reflect into more than single directions, so that they can be evaluated.
  constexpr bool evaluable() const { return cosine() || rough_specular() || coat || sheen; }
};

/// What textures of materials multiply; a scene's textures are looked up for each of these that a material
/// uses. Colours have sRGB texels of three channels, a normal has three linear ones, the others have one.
enum class TextureSlot { reflectance, emission, metallic, roughness, transmission, alpha, normal };
inline constexpr int kTextureSlots = 7;
constexpr bool is_colour(TextureSlot slot) {
  return slot == TextureSlot::reflectance || slot == TextureSlot::emission;
}
constexpr bool has_three_channels(TextureSlot slot) {
  return is_colour(slot) || slot == TextureSlot::normal;
}
/// Whether shadow rays look the slot up, at what they hit.
constexpr bool counts_for_shadow_rays(TextureSlot slot) {
  return slot == TextureSlot::emission || slot == TextureSlot::alpha;
}

/// The slots that materials of a scene have textures for.
struct TextureSlots {
  bool uses[kTextureSlots] = {};
  /// Wherever a triangle has textures of both, they are one image, as in glTF. Then roughness is looked up
  /// together with metallic.
  bool roughness_with_metallic = false;

  constexpr bool has(TextureSlot slot) const { return uses[int(slot)]; }
  /// Whether the slot has a look-up of its own.
  constexpr bool looks_up(TextureSlot slot) const {
    return has(slot) && !(slot == TextureSlot::roughness && roughness_with_metallic);
  }
  constexpr bool any_for_shadow_rays() const { return has(TextureSlot::emission) || has(TextureSlot::alpha); }
  constexpr bool any() const {
    bool any_slot = false;
    for (const bool uses_slot : uses) any_slot = any_slot || uses_slot;
    return any_slot;
  }
};

/// Lights that shadow rays are aimed at.
struct LightKinds {
  bool surfaces = true;      ///< triangles that emit
  bool points = false;       ///< points and spots
  bool distant = false;      ///< suns and parallel light
  bool environment = false;  ///< the environment's image

  constexpr bool without_triangles() const { return points || distant || environment; }
  constexpr bool any() const { return surfaces || without_triangles(); }
  /// Lights that segments can find as well.
  constexpr bool can_be_hit() const { return surfaces || environment; }
};

struct Features {
  Lobes lobes{true};
  LightKinds lights;
  bool environment = false;  ///< light of one colour that arrives from outside
  bool normals = false;      ///< that vary over triangles
  bool tangents = false;     ///< of normal textures, that vary over triangles
  TextureSlots textures;
  /// Kinds of materials that are shaded apart (Shading::material_bins); 1 where nothing tells them apart.
  int shading_kinds = 1;
  bool coverage = false;          ///< surfaces that let rays through, at least in places
  bool blended_coverage = false;  ///< some of them by chance
  /// Shadow rays and hits of lights are weighed against each other.
  bool multiple_importance = false;

  /// Whether hits and misses are looked up in images.
  constexpr bool looks_up() const { return textures.any() || lights.environment; }
  /// Whether normals of shading differ from those of triangles.
  constexpr bool shading_normals() const { return normals || textures.has(TextureSlot::normal); }

  /// Whether surfaces are diffuse, and light comes from triangles and arrives by shadow rays or by hits
  /// alone.
  constexpr bool plain() const {
    return lobes.only_diffuse() && !environment && !normals && !textures.any() && !coverage &&
           !multiple_importance && !lights.without_triangles();
  }
};

}  // namespace path_tracer
