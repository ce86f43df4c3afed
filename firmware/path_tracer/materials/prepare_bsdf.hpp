#pragma once

#include "firmware/path_tracer/materials/bsdf.hpp"

/// What a BSDF's evaluation and sampling share.
namespace path_tracer {

namespace bsdf_detail {

inline void assign(Rgb& to, const Rgb& from) {
  to.x.assign_all_lanes(from.x);
  to.y.assign_all_lanes(from.y);
  to.z.assign_all_lanes(from.z);
}

inline BaseShares base_shares(const Lobes& lobes, const Material& material) {
  const poly<double> dielectric = 1.0 - material.metallic;
  if (!lobes.transmissive()) return {dielectric, 0.0};
  const poly<double> transmissive = dielectric * material.transmission;
  return {dielectric - transmissive, transmissive};
}

/// Ways to reflect diffusely, and the albedo that couples them to the specular base.
struct CosinePart {
  CosineBase base;
  GgxAlbedo albedo;
};

/// Adds what frosted sheets scatter to what metal does.
inline void add_frosted(const Lobes& lobes, const Material& material, const poly<double>& frosted,
                        CosineBase& base) {
  assign(base.multiple, lobes.glossy ? plus(base.multiple, frosted) : Rgb{frosted, frosted, frosted});
  assign(base.behind, transmission_color(lobes, material) * frosted);
}

/// Estimates the albedo of the cosine's lobe, and how its samples are shared among the two sides. The light's
/// own loss is a factor of `multiple` and `behind` still; its average makes them albedos.
inline void estimate_albedo(const Lobes& lobes, const DirectionalAlbedo& average, CosineBase& base) {
  const poly<double> loss = cn::max(average.loss, poly<double>(kLeastAverageLoss));
  const Rgb multiple = base.multiple * loss;
  const poly<double> front = largest_channel(lobes.diffuse ? base.diffuse + multiple : multiple);
  if (!lobes.frosted_sheets()) {
    base.albedo.assign_all_lanes(front);
    return;
  }
  const poly<double> behind = largest_channel(base.behind) * loss;
  base.albedo.assign_all_lanes(front + behind);
  base.share_behind.assign_all_lanes(behind / keep_positive(base.albedo));
}

inline CosinePart cosine_part_under_specular(const Lobes& lobes, const Material& material,
                                             const BaseShares& shares, const poly<double>& alpha,
                                             const poly<double>& cos_viewer) {
  const AlbedoNeeds needs = base_albedo_needs(lobes);
  const GgxAlbedo albedo = ggx_albedo(needs, alpha);
  const DirectionalAlbedo viewer = directional_albedo(needs, albedo, cos_viewer);
  const DirectionalAlbedo average = average_albedo(needs, albedo, material.roughness);
  CosineBase base{};
  if (lobes.diffuse)
    assign(base.diffuse, material.base_color * (shares.opaque * coupling_viewer(material, average, viewer)));
  if (lobes.glossy) assign(base.multiple, multiple_scattering(material, average, viewer));
  if (lobes.frosted_sheets())
    add_frosted(lobes, material, frosted_scattering(material, shares.transmissive, average, viewer), base);
  if (scatters_often(lobes)) estimate_albedo(lobes, average, base);
  return {base, albedo};
}

inline CosinePart cosine_part(const BsdfConfig& config, const Material& material, const BaseShares& shares,
                              const SpecularBase& specular, const poly<double>& cos_viewer) {
  const Lobes& lobes = config.lobes;
  if (!lobes.cosine()) return {};
  CosinePart alone{};
  if (lobes.diffuse) assign(alone.base.diffuse, material.base_color);
  if (!lobes.specular()) return alone;
  if (scatters_often(lobes))
    alone.base.albedo.assign_all_lanes(lobes.diffuse ? largest_channel(alone.base.diffuse)
                                                     : poly<double>(0.0));
  return unless_absent(
      config, [&] { return specular.is_present(lobes); }, alone,
      [&] { return cosine_part_under_specular(lobes, material, shares, specular.alpha, cos_viewer); });
}

/// An estimate of the specular base's albedo: Schlick's reflectance for the macroscopic cosine, and all light
/// of the transmissive part.
inline poly<double> specular_estimate(const Lobes& lobes, const SpecularBase& base,
                                      const poly<double>& cos_viewer) {
  const poly<double> f0 = largest_channel(base.f0);
  const poly<double> opaque = f0 + (base.f90 - f0) * schlick_weight(cos_viewer);
  return lobes.transmissive() ? opaque + base.transmissive : opaque;
}

inline poly<double> cosine_estimate(const Lobes& lobes, const CosineBase& base) {
  return scatters_often(lobes) ? base.albedo : largest_channel(base.diffuse);
}

/// Samples in proportion to the lobes' albedos, so that no weight is much above the sum of the albedos.
inline SamplingShares sampling_shares(const Lobes& lobes, const BsdfTerms& terms) {
  if (lobes.ways_to_sample() == 1) return {1.0, 1.0, 1.0, 1.0};
  const LayerTransmittance& layers = terms.layers_viewer;
  const auto below_sheen = [&](const poly<double>& a) { return lobes.sheen ? a * layers.sheen : a; };
  const auto below_coat = [&](const poly<double>& a) { return lobes.coat ? a * layers.coat : a; };
  Sum sum;
  const auto add = [&](bool present, auto&& estimate) {
    const poly<double> albedo = present ? poly<double>(estimate()) : poly<double>(0.0);
    if (present) sum.add(albedo);
    return albedo;
  };
  const poly<double> specular = add(lobes.specular(), [&] {
    return below_coat(below_sheen(specular_estimate(lobes, terms.specular, terms.cos_viewer)));
  });
  const poly<double> cosine =
      add(lobes.cosine(), [&] { return below_coat(below_sheen(cosine_estimate(lobes, terms.cosine))); });
  const poly<double> coat = add(lobes.coat, [&] { return terms.coat.albedo_viewer; });
  const poly<double> sheen =
      add(lobes.sheen, [&] { return below_coat(sheen_albedo(terms.sheen, terms.sheen.raw_albedo_viewer)); });
  const poly<double> scale = 1.0 / keep_positive(sum.total());
  const auto share = [&](bool present, const poly<double>& albedo) {
    return present ? albedo * scale : albedo;
  };
  return {share(lobes.specular(), specular), share(lobes.coat, coat), share(lobes.sheen, sheen),
          share(lobes.cosine(), cosine)};
}

inline BsdfTerms bsdf_terms(const BsdfConfig& config, const Material& material,
                            const poly<double>& cos_viewer) {
  const Lobes& lobes = config.lobes;
  const BaseShares shares = lobes.specular() ? base_shares(lobes, material) : BaseShares{};
  const SpecularBase specular =
      lobes.specular() ? specular_base(lobes, material, shares, cos_viewer) : SpecularBase{};
  const CosinePart cosine = cosine_part(config, material, shares, specular, cos_viewer);
  const auto coat_present = [&] { return material.coat > 0.0; };
  const CoatLayer coat = lobes.coat ? unless_absent(config, coat_present, CoatLayer{},
                                                    [&] { return coat_layer(material, cos_viewer); })
                                    : CoatLayer{};
  const auto sheen_present = [&] { return largest_channel(material.sheen_color) > 0.0; };
  const SheenLayer sheen = lobes.sheen ? unless_absent(config, sheen_present, SheenLayer{},
                                                       [&] { return sheen_layer(material, cos_viewer); })
                                       : SheenLayer{};
  return {cos_viewer,
          specular,
          cosine.albedo,
          cosine.base,
          coat,
          sheen,
          {lobes.coat ? 1.0 - coat.albedo_viewer : poly<double>(1.0),
           lobes.sheen ? 1.0 - sheen_albedo(sheen, sheen.raw_albedo_viewer) : poly<double>(1.0)}};
}

}  // namespace bsdf_detail

/// Looks at a material from a direction. For purely diffuse materials it issues no instruction.
inline Bsdf prepare_bsdf(const BsdfConfig& config, const Material& material, const ShadingPoint& point) {
  using namespace bsdf_detail;
  if (config.lobes.only_diffuse()) {
    BsdfTerms terms{};
    assign(terms.cosine.diffuse, material.base_color);
    return {config, material, point, terms, {}};
  }
  const BsdfTerms terms = bsdf_terms(config, material, clamp_cosine(dot(point.normal, point.to_viewer)));
  return {config, material, point, terms, sampling_shares(config.lobes, terms)};
}

}  // namespace path_tracer
