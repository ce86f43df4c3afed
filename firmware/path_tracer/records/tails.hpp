#pragma once

#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/path_tracer/records/features.hpp"
#include "firmware/path_tracer/records/outside.hpp"
#include "firmware/path_tracer/records/records.hpp"

/// Records that follow others where the scene has use for them. A record and its tail are transferred as one.
namespace path_tracer {

/// Behind a HitRecord: how the ray arrived.
struct ArrivalRecord {
  vec3<double> direction{};  ///< of the ray, unit length
  double distance = 0;
};

/// Behind a SurfaceRecord: where a surface is, and where it lets rays through.
struct CoverageRecord {
  double alpha = 1;   ///< which a texture may multiply
  double cutoff = 0;  ///< the surface is where its alpha is no less; kByChance: with the probability alpha
  std::int32_t front_only = 0;  ///< 1: rays from behind pass; of surfaces by chance
  std::int32_t unused = 0;

  static constexpr double kByChance = -1;
};

/// Behind a SurfaceRecord: a material that is not only diffuse (materials/material.hpp).
struct MaterialRecord {
  double metallic = 0;
  double roughness = 1;  ///< the square root of GGX's width
  double f0 = 0;         ///< of what is not metal: reflectance at normal incidence
  double f90 = 0;        ///< the same at grazing incidence
  double transmission = 0;
  double ior = 1.5;       ///< index of refraction behind the front
  std::int32_t thin = 0;  ///< 1: transmits without refraction
  std::int32_t unused = 0;
};
struct VarnishTintRecord {
  vec3<double> tint{1, 1, 1};  ///< of the reflection at normal incidence; the strongest channel is 1
};
struct TransmissionTintRecord {
  vec3<double> colour{};     ///< of what passes, if it is another than the base colour
  std::int32_t is_base = 1;  ///< 1: it is the base colour
  std::int32_t unused = 0;
};
struct AbsorptionRecord {
  vec3<double> coefficient{};  ///< per unit of length
};
struct CoatRecord {
  double strength = 0;
  double roughness = 0;
};
struct SheenRecord {
  vec3<double> colour{};
  double roughness = 0;
};

/// Behind a SurfaceRecord: the normal of shading, before it is normalised, which is an affine function of the
/// position: at_origin + x along_x + y along_y + z along_z.
struct NormalRecord {
  vec3<double> at_origin{};
  vec3<double> along_x{};
  vec3<double> along_y{};
  vec3<double> along_z{};
};

/// Behind a SurfaceRecord, where hits wait in bins of their kind.
struct ShadingKindRecord {
  std::int32_t kind = 0;  ///< 0 to Features::shading_kinds - 1
  std::int32_t unused = 0;
};

/// Record of the bins of hits (Shading::material_bins): a ray whose search is over.
struct BinnedHit {
  cn::MonoAddress surface_place = 0;  ///< 0: it hit nothing
  cn::MonoAddress light_place = 0;
  std::int32_t slot = 0;
  std::int32_t unused = 0;
};

/// Behind a SurfaceRecord: how a normal texture lies on the triangle.
struct TangentRecord {
  vec3<double> tangent{};  ///< along which the texture's columns grow; unit length, in the triangle's plane
  double x_scale = 0;      ///< of what the texture says along the tangent
  double y_scale = 0;      ///< and along normal x tangent; negative where the image is mirrored
};

/// Behind a SurfaceRecord, in scenes whose files give tangents that vary over a triangle: the tangent at
/// `position` is TangentRecord's plus what these add, an affine function of the position. Then
/// TangentRecord's is that of the origin, and the sum need not have unit length.
struct TangentSlopeRecord {
  vec3<double> along_x{};
  vec3<double> along_y{};
  vec3<double> along_z{};
};

/// Values of TextureRecord::wrap_x and wrap_y: what stands beyond an image's edge (glTF 2.0,
/// section 3.8.4.5).
enum class TextureWrap : std::int32_t { repeat, mirrored_repeat, clamp_to_edge };

/// Behind a SurfaceRecord, for each texture slot of the scene: the triangle's texture in that slot. The place
/// in the image is an affine function of the position: x is x_at_origin + dot(x_along, position) texels to
/// the right of the image's left edge, y as many below its upper edge.
struct TextureRecord {
  double x_at_origin = 0;
  vec3<double> x_along{};
  double y_at_origin = 0;
  vec3<double> y_along{};
  cn::MonoAddress footprints = 0;  ///< of the image's texels, row by row; 0: the triangle has no texture here
  std::int32_t width = 1;          ///< in texels
  std::int32_t height = 1;
  std::int32_t wrap_x = 0;  ///< a TextureWrap
  std::int32_t wrap_y = 0;
  std::int32_t is_linear = 0;  ///< 1: bilinear filter, 0: the nearest texel
  std::int32_t unused = 0;
};

/// A texel of one channel with its right, lower and diagonal neighbours, where the image repeats beyond its
/// edges: all that a bilinear filter needs, so that a PE asks mono memory once and not four times. The
/// texels' 8-bit codes are, from the lowest byte: upper left, upper right, lower left, lower right.
using TexelFootprint = std::uint32_t;

/// In mono memory: footprints of a texel of slots with one channel, and of slots with three. A request moves
/// multiples of 8 bytes.
struct ChannelFootprint {
  TexelFootprint channel = 0;
  TexelFootprint roughness = 0;  ///< of metallic's slot, if TextureSlots::roughness_with_metallic
};
struct ColourFootprint {
  TexelFootprint red = 0;
  TexelFootprint green = 0;
  TexelFootprint blue = 0;
  std::uint32_t unused = 0;
};

constexpr int footprint_bytes(TextureSlot slot) {
  return has_three_channels(slot) ? int{sizeof(ColourFootprint)} : int{sizeof(ChannelFootprint)};
}

/// In SRAM for each texture slot of the scene, from the choice of the texel to the filter; its footprint
/// follows.
struct TextureLookUp {
  cn::MonoAddress place = 0;  ///< of the footprint
  double right_share = 0;     ///< of the right texels, in [0, 1]
  double lower_share = 0;
};

/// Behind a SurfaceRecord: how likely shadow rays find it.
struct AimRecord {
  double inverse_pdf = 0;  ///< LightRecord::inverse_pdf of the triangle's light; infinity if it is none
};

/// Behind a PathRecord and a ScatterRecord: how likely the segment's direction was.
struct DirectionRecord {
  double pdf = 0;  ///< by solid angle; infinity where no shadow ray competes with the segment
};

/// Behind a DirectionRecord: what the path has passed since the vertex that chose its direction.
struct PassedRecord {
  double distance = 0;
};

/// Behind a LightingRecord: what a shadow ray's random numbers depend on.
struct ShadowNumbersRecord {
  std::int32_t pixel = 0;
  std::int32_t sample = 0;
  std::int32_t depth = 0;
  std::int32_t unused = 0;
};

/// Places of the tails from the start of their records, in bytes, and sizes of the records with tails.
struct RecordSizes {
  int hit = sizeof(HitRecord);
  int surface = sizeof(SurfaceRecord);
  int scatter = sizeof(ScatterRecord);
  int path = sizeof(PathRecord);
  int lighting = sizeof(LightingRecord);
  int surface_of_shadow_ray = sizeof(SurfaceRecord);  ///< as much as shadow rays load
  bool has_passed = false;                            ///< PassedRecord, in paths and scatter records

  bool path_has_tail() const { return path > int{sizeof(PathRecord)}; }
  bool hit_has_tail() const { return hit > int{sizeof(HitRecord)}; }
  bool has_texture(TextureSlot slot) const { return texture[int(slot)] != kNone; }

  static constexpr int kNone = 0;
  // In a SurfaceRecord; kNone if the scene has none of it.
  int coverage = kNone;
  int material = kNone;
  int varnish_tint = kNone;
  int transmission_tint = kNone;
  int absorption = kNone;
  int coat = kNone;
  int sheen = kNone;
  int normal = kNone;
  int tangent = kNone;
  int tangent_slope = kNone;
  int texture[kTextureSlots] = {};
  int aim = kNone;
  int shading_kind = kNone;

  /// Look-ups of all texture slots of the scene, each a TextureLookUp and its footprint: bytes, and each
  /// slot's place in them.
  int look_ups = 0;
  int look_up[kTextureSlots] = {};
  int environment = kNone;  ///< place of the EnvironmentLookUp in them

  explicit RecordSizes(const Features& features) {
    const auto append = [this](bool present, std::size_t bytes) {
      if (!present) return kNone;
      const int place = surface;
      surface += static_cast<int>(bytes);
      return place;
    };
    shading_kind = append(features.shading_kinds > 1, sizeof(ShadingKindRecord));
    if (features.plain()) return;
    hit += int{sizeof(ArrivalRecord)};
    has_passed = features.coverage && features.multiple_importance;
    const int direction = int{sizeof(DirectionRecord)} + (has_passed ? int{sizeof(PassedRecord)} : 0);
    scatter += direction;
    path += direction;
    if (features.blended_coverage) lighting += int{sizeof(ShadowNumbersRecord)};
    const auto append_texture = [&](TextureSlot slot) {
      const bool looks_up = features.textures.looks_up(slot);
      texture[int(slot)] = append(looks_up, sizeof(TextureRecord));
      look_up[int(slot)] = look_ups;
      if (looks_up) look_ups += int{sizeof(TextureLookUp)} + footprint_bytes(slot);
    };
    // What shadow rays need comes first.
    coverage = append(features.coverage, sizeof(CoverageRecord));
    append_texture(TextureSlot::alpha);
    if (features.coverage) surface_of_shadow_ray = surface;
    material = append(features.lobes.specular(), sizeof(MaterialRecord));
    varnish_tint = append(features.lobes.varnish_tint, sizeof(VarnishTintRecord));
    transmission_tint = append(features.lobes.transmission_tint, sizeof(TransmissionTintRecord));
    absorption = append(features.lobes.absorption, sizeof(AbsorptionRecord));
    coat = append(features.lobes.coat, sizeof(CoatRecord));
    sheen = append(features.lobes.sheen, sizeof(SheenRecord));
    normal = append(features.normals, sizeof(NormalRecord));
    tangent = append(features.textures.has(TextureSlot::normal), sizeof(TangentRecord));
    tangent_slope = append(features.tangents, sizeof(TangentSlopeRecord));
    for (int slot = 0; slot < kTextureSlots; ++slot)
      if (TextureSlot(slot) != TextureSlot::alpha) append_texture(TextureSlot(slot));
    environment = look_ups;
    if (features.lights.environment) look_ups += int{sizeof(EnvironmentLookUp)};
    aim = append(features.multiple_importance, sizeof(AimRecord));
    if (features.textures.has(TextureSlot::emission)) surface_of_shadow_ray = surface;
  }
};

}  // namespace path_tracer
