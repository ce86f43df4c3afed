#pragma once

#include "firmware/path_tracer/materials/fresnel.hpp"
#include "firmware/path_tracer/materials/microfacet.hpp"
#include "firmware/path_tracer/materials/sheen.hpp"

/// A material seen from one direction: all that does not depend on where light comes from, so that a light
/// sample and the next segment share it.
///
/// The model, from the outside in. Each layer attenuates what is below by the smaller of its two directions'
/// transmittances. That is reciprocal, and no layer reflects more than it gets.
///   coat     GGX of index 1.5
///   sheen    fibres
///   base     metallic * metal + (1 - metallic) * ((1 - transmission) * varnish over diffuse
///            + transmission * dielectric)
/// Metal and varnish are GGX with Schlick's reflectance, the dielectric GGX with Fresnel's. What single
/// scattering loses in metal comes back as a lobe of its own (Kulla and Conty, "Revisiting Physically Based
/// Shading at Imageworks", SIGGRAPH course 2017). Below varnish the diffuse lobe takes it, by the same
/// construction. In a rough boundary between two media it is lost (docs/materials.md has the figures).
namespace path_tracer {

struct ShadingPoint {
  Direction3 normal;            ///< unit length, on the viewer's side; of shading
  Direction3 geometric_normal;  ///< likewise, of the triangle; read only with BsdfConfig::shading_normals
  Direction3 to_viewer;         ///< unit length; the viewer is where the path comes from
};

/// How samples are shared among the ways to sample; they add up to 1.
struct SamplingShares {
  poly<double> specular;
  poly<double> coat;
  poly<double> sheen;
  poly<double> cosine;
};

struct CoatLayer {
  poly<double> weight;
  poly<double> alpha;  ///< 0 if smooth
  poly<double> size_viewer;
  poly<double> albedo_viewer;
  GgxAlbedo albedo;
};

struct SheenLayer {
  Sheen fibres;
  poly<double> strongest;  ///< channel of the colour
  poly<double> raw_albedo_viewer;
};

struct SpecularBase {
  poly<double> alpha;  ///< 0 if smooth
  poly<double> size_viewer;
  Rgb f0;                     ///< of metal and varnish together
  poly<double> f90;           ///< likewise
  poly<double> transmissive;  ///< share of the base
  DielectricSurface surface;

  /// Where it reflects or transmits at all.
  mask is_present(const Lobes& lobes) const {
    return (lobes.transmissive() ? f90 + transmissive : f90) > 0.0;
  }
};

/// Reflectances with all factors but those of the light's direction.
struct CosineBase {
  Rgb diffuse;
  Rgb multiple;               ///< of the light that metal and frosted sheets scatter several times
  Rgb behind;                 ///< the same of what frosted sheets transmit
  poly<double> share_behind;  ///< of the samples
  poly<double> albedo;        ///< strongest channel of all of them; where light is scattered several times
};

/// Share of light that coat and sheen let through in one direction.
struct LayerTransmittance {
  poly<double> coat;
  poly<double> sheen;
};

/// What the viewer's direction determines. Parts that the program lacks are empty.
struct BsdfTerms {
  poly<double> cos_viewer;
  SpecularBase specular;
  GgxAlbedo albedo;  ///< of the specular base
  CosineBase cosine;
  CoatLayer coat;
  SheenLayer sheen;
  LayerTransmittance layers_viewer;
};

struct Bsdf {
  BsdfConfig config;
  Material material;
  ShadingPoint point;
  BsdfTerms terms;
  SamplingShares shares;
};

inline poly<double> largest_channel(const Rgb& color) {
  return cn::max(color.x, cn::max(color.y, color.z));
}

/// Runs `body`. A program that skips absent lobes does so only if `present` holds on any PE; `absent` is the
/// result of the others. Masks in a result are those of `body` on all PEs.
template <class Value, class Present, class Body>
inline Value unless_absent(const BsdfConfig& config, Present&& present, const Value& absent, Body&& body) {
  if (!config.skips_absent_lobes) return body();
  Value value = absent;
  cn::poly_if_any(present(), [&] { value = body(); });
  return value;
}

namespace bsdf_detail {

/// The coat's reflectance at normal incidence (KHR_materials_clearcoat).
inline constexpr double kCoatF0 = 0.04;

/// Coats are rough or smooth.
inline constexpr AlbedoNeeds kCoatAlbedo{true, true, true};

/// Whether light that facets scatter several times is a part of the cosine's lobe.
constexpr bool scatters_often(const Lobes& lobes) {
  return lobes.glossy || lobes.frosted_sheets();
}

constexpr AlbedoNeeds base_albedo_needs(const Lobes& lobes) {
  return {lobes.rough_specular(), lobes.smooth_specular(), lobes.diffuse};
}

/// Least factor by which coupling divides: fits err by 0.003, and their product must stay small beside it.
inline constexpr double kLeastCoupling = 0.01;

/// Least average loss to divide by. Below alpha = 0.035 the light that is scattered several times is not all
/// returned; that concerns directions within 4 degrees of grazing. Without it, weights would have no bound.
inline constexpr double kLeastAverageLoss = 3e-3;

/// GGX's width where both smooth and rough surfaces may occur.
inline poly<double> alpha_or_smooth(const poly<double>& roughness) {
  const poly<double> alpha = roughness * roughness;
  return cn::select(alpha < kSmoothAlpha, poly<double>(0.0), alpha);
}

inline poly<double> specular_alpha(const Lobes& lobes, const poly<double>& roughness) {
  if (!lobes.rough_specular()) return 0.0;
  if (lobes.smooth_specular()) return alpha_or_smooth(roughness);
  return cn::max(roughness * roughness, poly<double>(kSmoothAlpha));
}

/// Keeps eta away from 1, where refraction by a rough surface would have an infinite density.
inline poly<double> keep_from_one(const poly<double>& eta) {
  constexpr double kLeast = 1.0 + 1e-4;
  return cn::select(eta < 1.0, cn::min(eta, poly<double>(1.0 / kLeast)), cn::max(eta, poly<double>(kLeast)));
}

inline DielectricSurface dielectric_surface(const Lobes& lobes, const poly<double>& material_eta,
                                            const poly<double>& alpha) {
  constexpr double kNotZero = 1e-3;
  const poly<double> eta = cn::max(material_eta, poly<double>(kNotZero));
  if (!lobes.rough_glass) return {eta, 1.0 / eta};
  const poly<double> rough_eta = keep_from_one(eta);
  const poly<double> used = lobes.smooth_specular() ? cn::select(alpha > 0.0, rough_eta, eta) : rough_eta;
  return {used, 1.0 / used};
}

inline Rgb plus(const Rgb& color, const poly<double>& gray) {
  return {color.x + gray, color.y + gray, color.z + gray};
}

/// Shares of the base besides metal.
struct BaseShares {
  poly<double> opaque;
  poly<double> transmissive;
};

/// Reflectance of metal and varnish at normal incidence.
inline Rgb base_at_normal(const Lobes& lobes, const Material& material, const BaseShares& shares) {
  const Rgb metal = material.base_color * material.metallic;
  const poly<double> varnish = shares.opaque * material.f0;
  return lobes.varnish_tint ? metal + material.varnish_tint * varnish : plus(metal, varnish);
}

inline SpecularBase specular_base(const Lobes& lobes, const Material& material, const BaseShares& shares,
                                  const poly<double>& cos_viewer) {
  const poly<double> alpha = specular_alpha(lobes, material.roughness);
  return {alpha,
          lobes.rough_specular() ? ggx_size(alpha * alpha, cos_viewer) : poly<double>(0.0),
          base_at_normal(lobes, material, shares),
          material.metallic + shares.opaque * material.f90,
          shares.transmissive,
          lobes.transmissive() ? dielectric_surface(lobes, material.eta, alpha) : DielectricSurface{}};
}

/// Diffuse reflectance under varnish (Kulla and Conty 2017): what varnish does not reflect, on the way in and
/// out, divided by its average so that a white one loses nothing.
inline poly<double> coupling_viewer(const Material& material, const DirectionalAlbedo& average,
                                    const DirectionalAlbedo& viewer) {
  return cn::max(1.0 - schlick_albedo(viewer, material.f0, material.f90), poly<double>(0.0)) /
         cn::max(1.0 - schlick_albedo(average, material.f0, material.f90), poly<double>(kLeastCoupling));
}

/// The share of light that metal reflects after more than one scattering, without the loss of the light's
/// direction: a geometric series (Kulla and Conty 2017). The three channels share one quotient.
inline Rgb multiple_scattering(const Material& material, const DirectionalAlbedo& average,
                               const DirectionalAlbedo& viewer) {
  const auto fresnel = [](const poly<double>& base) {  // average of Schlick's with f90 = 1
    return (20.0 * base + 1.0) * (1.0 / 21.0);
  };
  const Rgb f{fresnel(material.base_color.x), fresnel(material.base_color.y), fresnel(material.base_color.z)};
  const Rgb rest{1.0 - f.x * average.loss, 1.0 - f.y * average.loss, 1.0 - f.z * average.loss};
  const poly<double> rest_xy = rest.x * rest.y;
  const poly<double> all = rest_xy * rest.z * cn::max(average.loss, poly<double>(kLeastAverageLoss));
  const poly<double> factor = material.metallic * viewer.loss * (1.0 - average.loss) / all;
  return f * f * Rgb{factor * rest.y * rest.z, factor * rest.x * rest.z, factor * rest_xy};
}

/// The same of a frosted sheet. No light stays in it; half of it is taken to leave on either side.
inline poly<double> frosted_scattering(const Material& material, const poly<double>& transmissive,
                                       const DirectionalAlbedo& average, const DirectionalAlbedo& viewer) {
  const poly<double> factor =
      0.5 * transmissive * viewer.loss / cn::max(average.loss, poly<double>(kLeastAverageLoss));
  return cn::select(material.thin, factor, poly<double>(0.0));
}

inline CoatLayer coat_layer(const Material& material, const poly<double>& cos_viewer) {
  const poly<double> alpha = alpha_or_smooth(material.coat_roughness);
  const GgxAlbedo albedo = ggx_albedo(kCoatAlbedo, alpha);
  return {material.coat, alpha, ggx_size(alpha * alpha, cos_viewer),
          material.coat * schlick_albedo(directional_albedo(kCoatAlbedo, albedo, cos_viewer), kCoatF0, 1.0),
          albedo};
}

inline SheenLayer sheen_layer(const Material& material, const poly<double>& cos_viewer) {
  const Sheen fibres = sheen_of(material.sheen_roughness);
  return {fibres, largest_channel(material.sheen_color), raw_sheen_albedo(fibres, cos_viewer)};
}

inline poly<double> sheen_albedo(const SheenLayer& layer, const poly<double>& raw_albedo) {
  return layer.strongest * cn::min(raw_albedo, poly<double>(1.0));
}

}  // namespace bsdf_detail

}  // namespace path_tracer
