#pragma once

#include "firmware/path_tracer/materials/prepare_bsdf.hpp"

/// The value of a BSDF for a pair of directions, and the density with which sample_bsdf() finds the second.
namespace path_tracer {

struct BsdfValue {
  Rgb value;  ///< BSDF * cosine of the light, for radiance; 0 on the wrong side. Without mirrors and glass.
  poly<double> pdf;  ///< per solid angle; 0 where the value is 0 by its side
};

namespace bsdf_detail {

/// What the light's direction determines. Where it is on a side that gets no light, it is replaced by the
/// normal, so that all is finite.
struct LightSide {
  Direction3 to_light;
  poly<double> cosine;  ///< clamped, positive on either side
  mask lit;
  mask transmits;
};

inline LightSide light_side(const Bsdf& bsdf, const Direction3& to_light) {
  const poly<double> cosine = dot(bsdf.point.normal, to_light);
  const bool transmissive = bsdf.config.lobes.transmissive();
  const poly<double> height = transmissive ? cn::abs(cosine) : cosine;
  mask lit = height > kLeastCosine;
  if (bsdf.config.shading_normals) {
    const poly<double> same_side = dot(bsdf.point.geometric_normal, to_light) * cosine;
    const poly<double> seen = dot(bsdf.point.normal, bsdf.point.to_viewer);
    lit = lit & (same_side > 0.0) & (seen > kLeastCosine);
  }
  return {cn::select(lit, to_light, bsdf.point.normal),
          cn::select(lit, cn::min(height, poly<double>(1.0)), poly<double>(1.0)), lit,
          transmissive ? lit & (cosine < 0.0) : mask()};
}

/// Schlick's reflectance of metal and varnish.
inline Rgb opaque_reflectance(const SpecularBase& base, const poly<double>& cosine) {
  const poly<double> weight = schlick_weight(cosine);
  const auto schlick = [&](const poly<double>& f0) { return f0 + (base.f90 - f0) * weight; };
  return {schlick(base.f0.x), schlick(base.f0.y), schlick(base.f0.z)};
}

/// Specular reflectance and transmittance at a facet, and the share of samples that are reflected.
struct FacetSplit {
  Rgb reflectance;
  Rgb transmittance;  ///< of radiance, which refraction compresses: (1 - F) / eta^2
  poly<double> reflected_share;
};

inline FacetSplit split_at_facet(const Bsdf& bsdf, const poly<double>& cosine) {
  const SpecularBase& base = bsdf.terms.specular;
  const Rgb opaque = opaque_reflectance(base, cosine);
  if (!bsdf.config.lobes.transmissive()) return {opaque, {}, 1.0};
  const poly<double> fresnel =
      dielectric_fresnel(base.surface, cosine, refracted_cosine(base.surface, cosine));
  const Rgb reflectance = plus(opaque, base.transmissive * fresnel);
  const Rgb transmitted =
      transmission_color(bsdf.config.lobes, bsdf.material) * (base.transmissive * (1.0 - fresnel));
  const poly<double> reflected = largest_channel(reflectance);
  const poly<double> sum = reflected + largest_channel(transmitted);
  const poly<double> refracted = base.surface.inverse_eta * base.surface.inverse_eta;
  const poly<double> compression =
      bsdf.config.lobes.thin_glass ? cn::select(bsdf.material.thin, poly<double>(1.0), refracted) : refracted;
  return {reflectance, transmitted * compression, reflected / keep_positive(sum)};
}

/// The facet normal that reflects or refracts the viewer into the light, and the cosines with it.
struct Facet {
  HalfVector half;
  poly<double> cos_viewer;
  poly<double> cos_light;  ///< where it refracts: negative if that is possible
  mask refracts;
};

/// Half the length of the sum of two unit vectors is the cosine of half their angle.
inline poly<double> cosine_of_half_angle(const poly<double>& length) {
  return cn::min(0.5 * length, poly<double>(1.0));
}

inline Facet reflecting_facet(const Bsdf& bsdf, const LightSide& light) {
  const HalfVector half = half_vector(bsdf.point.to_viewer + light.to_light, bsdf.point.normal);
  return {half, cosine_of_half_angle(cn::sqrt(half.length_squared)), {}, {}};
}

/// Thin sheets transmit what they would reflect to the mirrored direction.
inline Facet reflecting_or_refracting_facet(const Bsdf& bsdf, const LightSide& light) {
  const ShadingPoint& point = bsdf.point;
  const bool thin = bsdf.config.lobes.thin_glass;
  const mask refracts = thin ? light.transmits & !bsdf.material.thin : light.transmits;
  const Direction3 to_light =
      thin ? cn::select(light.transmits & bsdf.material.thin,
                        mirror_at_plane(light.to_light, point.normal, -light.cosine), light.to_light)
           : light.to_light;
  const poly<double> scale = cn::select(refracts, bsdf.terms.specular.surface.eta, poly<double>(1.0));
  const HalfVector half = half_vector(point.to_viewer + to_light * scale, point.normal);
  const poly<double> length = cn::sqrt(keep_positive(half.length_squared));
  const poly<double> outward = cn::flip_sign(1.0 / length, half.along);
  const poly<double> refracting = cn::min(dot(half.direction, point.to_viewer) * outward, poly<double>(1.0));
  return {half, cn::select(refracts, refracting, cosine_of_half_angle(length)),
          dot(half.direction, to_light) * outward, refracts};
}

inline Facet facet_between(const Bsdf& bsdf, const LightSide& light) {
  return bsdf.config.lobes.rough_glass ? reflecting_or_refracting_facet(bsdf, light)
                                       : reflecting_facet(bsdf, light);
}

struct LobeValue {
  Rgb value;
  poly<double> pdf;
};

/// GGX reflection or refraction. Both are D G2 / (cosines) times a Jacobian and a reflectance. Refraction has
/// Walter et al.'s (2007, equation 17) with the half vector's length for its denominator.
inline LobeValue evaluate_rough_base(const Bsdf& bsdf, const LightSide& light, const Facet& facet) {
  const SpecularBase& base = bsdf.terms.specular;
  const poly<double>& cos_viewer = bsdf.terms.cos_viewer;
  const poly<double> alpha_squared = base.alpha * base.alpha;
  const poly<double> distribution = ggx_distribution(alpha_squared, facet.half);
  const poly<double> size_light = ggx_size(alpha_squared, light.cosine);
  const poly<double> visible = 2.0 * distribution / (cos_viewer + base.size_viewer);
  const poly<double> shadowed =
      distribution * light.cosine * ggx_visibility(cos_viewer, base.size_viewer, light.cosine, size_light);
  if (!bsdf.config.lobes.rough_glass)
    return {opaque_reflectance(base, facet.cos_viewer) * (0.25 * shadowed), 0.25 * visible};
  const mask possible = (facet.cos_viewer > 0.0) & ((!facet.refracts) | (facet.cos_light < 0.0));
  const poly<double> cosine = cn::max(facet.cos_viewer, poly<double>(kLeastCosine));
  const FacetSplit split = split_at_facet(bsdf, cosine);
  const poly<double> eta_squared = base.surface.eta * base.surface.eta;
  const poly<double> refraction =
      cosine * cn::abs(facet.cos_light) * eta_squared / keep_positive(facet.half.length_squared);
  const poly<double> jacobian = cn::select(facet.refracts, refraction, poly<double>(0.25));
  const poly<double> used = cn::select(possible, jacobian, poly<double>(0.0));
  const poly<double> share = cn::select(light.transmits, 1.0 - split.reflected_share, split.reflected_share);
  const Rgb reflectance = cn::select(light.transmits, split.transmittance, split.reflectance);
  return {reflectance * (shadowed * used), visible * used * share};
}

inline poly<double> coat_fresnel(const poly<double>& cosine) {
  return kCoatF0 + (1.0 - kCoatF0) * schlick_weight(cosine);
}

struct GrayValue {
  poly<double> value;
  poly<double> pdf;
  poly<double> transmittance;  ///< of the layer in the light's direction
};

inline GrayValue evaluate_coat(const Bsdf& bsdf, const LightSide& light, const Facet& facet) {
  const CoatLayer& coat = bsdf.terms.coat;
  const poly<double>& cos_viewer = bsdf.terms.cos_viewer;
  const poly<double> alpha_squared = coat.alpha * coat.alpha;
  const poly<double> distribution = 0.25 * ggx_distribution(alpha_squared, facet.half);
  const poly<double> size_light = ggx_size(alpha_squared, light.cosine);
  const poly<double> visibility = ggx_visibility(cos_viewer, coat.size_viewer, light.cosine, size_light);
  const poly<double> albedo =
      coat.weight * schlick_albedo(directional_albedo(kCoatAlbedo, coat.albedo, light.cosine), kCoatF0, 1.0);
  return {coat.weight * coat_fresnel(facet.cos_viewer) * distribution * light.cosine * visibility,
          2.0 * distribution / (cos_viewer + coat.size_viewer), 1.0 - albedo};
}

inline GrayValue evaluate_sheen_layer(const Bsdf& bsdf, const LightSide& light, const Facet& facet) {
  const SheenLayer& sheen = bsdf.terms.sheen;
  const poly<double> raw_albedo = raw_sheen_albedo(sheen.fibres, light.cosine);
  const poly<double> squared_sine = facet.half.across_squared / keep_positive(facet.half.length_squared);
  return {light.cosine * evaluate_sheen(sheen.fibres, squared_sine, bsdf.terms.cos_viewer, light.cosine,
                                        sheen.raw_albedo_viewer, raw_albedo),
          1.0 / (2.0 * kPi), 1.0 - sheen_albedo(sheen, raw_albedo)};
}

inline LobeValue evaluate_cosine_base(const Bsdf& bsdf, const LightSide& light) {
  const Lobes& lobes = bsdf.config.lobes;
  const Material& material = bsdf.material;
  const CosineBase& base = bsdf.terms.cosine;
  const poly<double> pdf = light.cosine * (1.0 / kPi);
  if (!lobes.specular()) return {base.diffuse * pdf, pdf};
  const DirectionalAlbedo albedo = unless_absent(
      bsdf.config, [&] { return bsdf.terms.specular.is_present(lobes); }, DirectionalAlbedo{0.0, 0.0},
      [&] { return directional_albedo(base_albedo_needs(lobes), bsdf.terms.albedo, light.cosine); });
  RgbSum reflectance;
  if (lobes.diffuse)
    reflectance.add(base.diffuse *
                    cn::max(1.0 - schlick_albedo(albedo, material.f0, material.f90), poly<double>(0.0)));
  if (scatters_often(lobes)) reflectance.add(base.multiple * albedo.loss);
  if (!lobes.frosted_sheets()) return {reflectance.total() * pdf, pdf};
  const Rgb value = cn::select(light.transmits, base.behind * albedo.loss, reflectance.total());
  return {value * pdf, pdf * cn::select(light.transmits, base.share_behind, 1.0 - base.share_behind)};
}

/// A value with what sampling needs of it.
struct EvaluatedBsdf {
  BsdfValue value;
  LightSide light;
  LayerTransmittance layers;  ///< the smaller transmittances of both directions
};

/// The lobes of the base, before they are dimmed by the layers above.
inline LobeValue evaluate_base(const Bsdf& bsdf, const LightSide& light, const Facet& facet,
                               const mask& reflects) {
  const Lobes& lobes = bsdf.config.lobes;
  const bool mixes = lobes.ways_to_sample() > 1;
  const auto share = [&](const poly<double>& pdf, const poly<double>& of) { return mixes ? pdf * of : pdf; };
  const Rgb none{0.0, 0.0, 0.0};
  RgbSum value;
  Sum pdf;
  if (lobes.rough_specular()) {
    const LobeValue rough = unless_absent(
        bsdf.config, [&] { return bsdf.terms.specular.is_present(lobes); }, LobeValue{none, 0.0},
        [&] { return evaluate_rough_base(bsdf, light, facet); });
    const poly<double> weighed = share(rough.pdf, bsdf.shares.specular);
    const bool only_front = lobes.transmissive() && !lobes.rough_glass;
    value.add(only_front ? cn::select(reflects, rough.value, none) : rough.value);
    pdf.add(only_front ? cn::select(reflects, weighed, poly<double>(0.0)) : weighed);
  }
  if (lobes.cosine()) {
    const LobeValue cosine = evaluate_cosine_base(bsdf, light);
    const poly<double> weighed = share(cosine.pdf, bsdf.shares.cosine);
    const bool only_front = lobes.transmissive() && !lobes.frosted_sheets();
    value.add(only_front ? cn::select(reflects, cosine.value, none) : cosine.value);
    pdf.add(only_front ? cn::select(reflects, weighed, poly<double>(0.0)) : weighed);
  }
  return {value.total(), pdf.total()};
}

/// Adds coat and sheen to the base, and dims what is below each. Only reflection meets their front.
inline EvaluatedBsdf evaluate_layers(const Bsdf& bsdf, const LightSide& light, const Facet& facet,
                                     const mask& reflects, const LobeValue& base) {
  const BsdfConfig& config = bsdf.config;
  const Lobes& lobes = config.lobes;
  const Material& material = bsdf.material;
  const GrayValue absent{0.0, 0.0, 1.0};
  const poly<double> zero = 0.0;
  const auto in_front = [&](const poly<double>& a) {
    return lobes.transmissive() ? cn::select(reflects, a, zero) : a;
  };
  Rgb value = base.value;
  poly<double> pdf = base.pdf;
  const bool has_base = lobes.cosine() || lobes.rough_specular();
  LayerTransmittance layers{1.0, 1.0};
  if (lobes.sheen) {
    const GrayValue sheen = unless_absent(
        config, [&] { return bsdf.terms.sheen.strongest > 0.0; }, absent,
        [&] { return evaluate_sheen_layer(bsdf, light, facet); });
    layers.sheen.assign_all_lanes(cn::min(bsdf.terms.layers_viewer.sheen, sheen.transmittance));
    const Rgb own = material.sheen_color * in_front(sheen.value);
    assign(value, has_base ? value * layers.sheen + own : own);
    const poly<double> own_pdf = in_front(sheen.pdf * bsdf.shares.sheen);
    pdf.assign_all_lanes(has_base ? pdf + own_pdf : own_pdf);
  }
  if (lobes.coat) {
    const GrayValue coat = unless_absent(
        config, [&] { return material.coat > 0.0; }, absent,
        [&] { return evaluate_coat(bsdf, light, facet); });
    layers.coat.assign_all_lanes(cn::min(bsdf.terms.layers_viewer.coat, coat.transmittance));
    assign(value, plus(value * layers.coat, in_front(coat.value)));
    pdf.assign_all_lanes(pdf + in_front(coat.pdf * bsdf.shares.coat));
  }
  return {{value, pdf}, light, layers};
}

/// Where a lobe other than the cosine's is present.
inline mask has_facets(const Bsdf& bsdf) {
  const Lobes& lobes = bsdf.config.lobes;
  Sum presence;
  if (lobes.rough_specular()) presence.add(bsdf.terms.specular.f90);
  if (lobes.rough_glass) presence.add(bsdf.terms.specular.transmissive);
  if (lobes.coat) presence.add(bsdf.material.coat);
  if (lobes.sheen) presence.add(bsdf.terms.sheen.strongest);
  return presence.total() > 0.0;
}

/// Lambert's law needs no guard: a cosine of 0 makes all 0.
inline EvaluatedBsdf evaluate_only_diffuse(const Bsdf& bsdf, const Direction3& to_light) {
  const poly<double> pdf = cn::max(dot(bsdf.point.normal, to_light), poly<double>(0.0)) * (1.0 / kPi);
  return {{bsdf.terms.cosine.diffuse * pdf, pdf}, {}, {}};
}

inline EvaluatedBsdf evaluate(const Bsdf& bsdf, const Direction3& to_light) {
  const Lobes& lobes = bsdf.config.lobes;
  if (lobes.only_diffuse() && !bsdf.config.shading_normals) return evaluate_only_diffuse(bsdf, to_light);
  const LightSide light = light_side(bsdf, to_light);
  const mask reflects = lobes.transmissive() ? !light.transmits : mask();
  const bool needs_facet = lobes.rough_specular() || lobes.coat || lobes.sheen;
  const Facet facet = needs_facet ? unless_absent(
                                        bsdf.config, [&] { return has_facets(bsdf); }, Facet{},
                                        [&] { return facet_between(bsdf, light); })
                                  : Facet{};
  const LobeValue base = evaluate_base(bsdf, light, facet, reflects);
  const EvaluatedBsdf all = evaluate_layers(bsdf, light, facet, reflects, base);
  const Rgb none{0.0, 0.0, 0.0};
  return {
      {cn::select(light.lit, all.value.value, none), cn::select(light.lit, all.value.pdf, poly<double>(0.0))},
      light,
      all.layers};
}

}  // namespace bsdf_detail

/// Evaluates all lobes but mirrors and smooth glass.
/// @param to_light unit length, from the surface, on either side
inline BsdfValue evaluate_bsdf(const Bsdf& bsdf, const Direction3& to_light) {
  return bsdf_detail::evaluate(bsdf, to_light).value;
}

}  // namespace path_tracer
