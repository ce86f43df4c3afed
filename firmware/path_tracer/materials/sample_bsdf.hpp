#pragma once

#include "firmware/path_tracer/materials/evaluate_bsdf.hpp"
#include "firmware/path_tracer/sampling/sampler.hpp"

/// The next segment of a path: a direction with the weight of the radiance that comes from there.
namespace path_tracer {

struct BsdfSample {
  Direction3 direction;
  Rgb weight;  ///< BSDF * cosine / pdf; 0 ends the path
  /// Per solid angle, as evaluate_bsdf() gives it. 0 for a single direction, and for purely diffuse materials
  /// without BsdfConfig::diffuse_pdf.
  poly<double> pdf;
  mask is_delta;   ///< the direction has no density: lights are not sampled towards it
  mask transmits;  ///< the segment goes on behind the surface
};

namespace bsdf_detail {

/// The way by which each PE samples. Where the program has one way only, all PEs use it.
struct WayToSample {
  mask specular;
  mask coat;
  mask sheen;
  mask sphere;  ///< by cosine or sheen
};

/// Walks the shares in the order specular, coat, sheen, cosine. The last way that the program has takes what
/// is left.
inline WayToSample choose_way(const Bsdf& bsdf, const poly<double>& choice) {
  const Lobes& lobes = bsdf.config.lobes;
  const mask all(cn::mask_from_bits(0xff));
  const mask none(cn::mask_from_bits(0));
  const bool more_than_specular = lobes.coat || lobes.sheen || lobes.cosine();
  WayToSample way{none, none, none, none};
  if (lobes.specular()) way.specular = more_than_specular ? choice < bsdf.shares.specular : all;
  if (!more_than_specular) return way;
  mask left = lobes.specular() ? !way.specular : all;
  poly<double> edge = lobes.specular() ? bsdf.shares.specular : poly<double>(0.0);
  if (lobes.coat) {
    edge.assign_all_lanes(edge + bsdf.shares.coat);
    way.coat = lobes.sheen || lobes.cosine() ? left & (choice < edge) : left;
    left = left & !way.coat;
  }
  way.sphere = left;
  if (lobes.sheen) way.sheen = lobes.cosine() ? left & (choice < edge + bsdf.shares.sheen) : left;
  return way;
}

/// Whether a PE samples a smooth specular base.
inline mask chooses_mirror(const Bsdf& bsdf, const WayToSample& way) {
  if (!bsdf.config.lobes.rough_specular()) return way.specular;
  return way.specular & (bsdf.terms.specular.alpha == 0.0);
}

/// What a way to sample starts from: a cap of the sphere and the viewer's place on it.
struct Cap {
  poly<double> alpha;
  StretchedViewer viewer;
};

inline Cap facet_cap(const Bsdf& bsdf, const WayToSample& way) {
  const Lobes& lobes = bsdf.config.lobes;
  const SpecularBase& base = bsdf.terms.specular;
  const CoatLayer& coat = bsdf.terms.coat;
  const poly<double>& cosine = bsdf.terms.cos_viewer;
  const poly<double> base_size = lobes.rough_specular() ? base.size_viewer : cosine;
  const bool both = lobes.coat && lobes.specular();
  const poly<double> alpha = both         ? cn::select(way.coat, coat.alpha, base.alpha)
                             : lobes.coat ? coat.alpha
                                          : base.alpha;
  const poly<double> size = both         ? cn::select(way.coat, coat.size_viewer, base_size)
                            : lobes.coat ? coat.size_viewer
                                         : base_size;
  return {alpha, stretch_viewer(bsdf.point.to_viewer, bsdf.point.normal, cosine, alpha, size)};
}

/// Turns a direction around the z axis to one around the normal.
inline Direction3 turn_to(const Direction3& normal, const Direction3& direction) {
  const Tangents frame = tangents(normal);
  return frame.first * direction.x + frame.second * direction.y + normal * direction.z;
}

/// Samples a facet's normal as the viewer sees them (Dupuy and Benyoub, "Sampling Visible GGX Normals with
/// Spherical Caps", CGF 42(8), 2023), and by the same instructions a cosine-distributed direction: the
/// viewer's place on the whole sphere is the normal then. The latter is sample_cosine() to the bit.
inline Direction3 axis_of_cap(const Bsdf& bsdf, const WayToSample& way, const Cap& cap,
                              const Direction3& on_cap) {
  const Direction3& normal = bsdf.point.normal;
  const bool spheres = bsdf.config.lobes.cosine() || bsdf.config.lobes.sheen;
  const Direction3 turned = unless_absent(
      bsdf.config, [&] { return way.specular | way.coat; }, on_cap, [&] { return turn_to(normal, on_cap); });
  const Direction3 place =
      spheres ? cn::select(way.sphere, normal, cap.viewer.direction) : cap.viewer.direction;
  const Direction3 half = place + (spheres ? cn::select(way.sphere, on_cap, turned) : turned);
  const poly<double> along = cn::max(cap.viewer.height + on_cap.z, poly<double>(0.0));
  return normalize(half * cap.alpha + normal * ((1.0 - cap.alpha) * along), normal);
}

/// Where no PE samples a facet, the cap is the whole sphere.
inline Cap cap_to_sample(const Bsdf& bsdf, const WayToSample& way) {
  const Lobes& lobes = bsdf.config.lobes;
  const poly<double> one = 1.0;
  if (!lobes.rough_specular() && !lobes.coat) return {one, {bsdf.point.normal, one}};
  const Cap cap = unless_absent(
      bsdf.config, [&] { return way.specular | way.coat; }, Cap{one, {bsdf.point.normal, one}},
      [&] { return facet_cap(bsdf, way); });
  if (!lobes.cosine() && !lobes.sheen) return cap;
  return {cn::select(way.sphere, one, cap.alpha),
          {cap.viewer.direction, cn::select(way.sphere, one, cap.viewer.height)}};
}

/// Turns a direction to the normal's side: a uniform one on the sphere becomes one on the hemisphere.
inline Direction3 turn_to_front(const Direction3& direction, const Direction3& normal) {
  const poly<double> cosine = dot(direction, normal);
  return {cn::flip_sign(direction.x, cosine), cn::flip_sign(direction.y, cosine),
          cn::flip_sign(direction.z, cosine)};
}

/// The facet that a sample leaves from; for samples of the sphere, the direction itself.
inline Direction3 sample_axis(const Bsdf& bsdf, const WayToSample& way, const UniformPair& uniform) {
  const Lobes& lobes = bsdf.config.lobes;
  const Direction3& normal = bsdf.point.normal;
  const bool caps = lobes.rough_specular() || lobes.coat;
  if (!caps && !lobes.cosine() && !lobes.sheen) return normal;
  const Cap cap = cap_to_sample(bsdf, way);
  const Direction3 on_cap = sample_cap(cap.viewer.height, uniform.u, uniform.v);
  const bool normalizes = caps || lobes.cosine();
  const Direction3 axis = caps         ? axis_of_cap(bsdf, way, cap, on_cap)
                          : normalizes ? normalize(normal + on_cap, normal)
                                       : normal;
  const Direction3 with_sheen = lobes.sheen
                                    ? (normalizes ? cn::select(way.sheen, turn_to_front(on_cap, normal), axis)
                                                  : turn_to_front(on_cap, normal))
                                    : axis;
  if (!lobes.smooth_specular()) return with_sheen;
  return cn::select(chooses_mirror(bsdf, way), normal, with_sheen);
}

/// A direction, and how it was found.
struct Departure {
  Direction3 direction;
  mask transmits;
  FacetSplit split;     ///< at the facet; empty where there is nothing to choose
  poly<double> cosine;  ///< between viewer and facet
};

/// Light that a facet refracts, or a thin sheet lets through.
inline Direction3 transmit(const Bsdf& bsdf, const Direction3& axis, const Direction3& reflected,
                           const poly<double>& cosine) {
  const DielectricSurface& surface = bsdf.terms.specular.surface;
  const Direction3& normal = bsdf.point.normal;
  const Direction3 refracted =
      refract(surface, bsdf.point.to_viewer, axis, cosine, refracted_cosine(surface, cosine));
  if (!bsdf.config.lobes.thin_glass) return refracted;
  return cn::select(bsdf.material.thin, mirror_at_plane(reflected, normal, dot(reflected, normal)),
                    refracted);
}

/// Samples of the sphere that go on behind a frosted sheet: the last part of the cosine's share.
inline mask goes_behind(const Bsdf& bsdf, const WayToSample& way, const poly<double>& choice) {
  const poly<double> from = 1.0 - bsdf.shares.cosine * bsdf.terms.cosine.share_behind;
  const mask behind = way.sphere & (choice >= from);
  return bsdf.config.lobes.sheen ? behind & !way.sheen : behind;
}

/// Reflects or transmits at a facet. PEs that sample the sphere transmit nothing.
inline Departure depart_from_facet(const Bsdf& bsdf, const WayToSample& way, const Direction3& axis,
                                   const poly<double>& choice) {
  const Lobes& lobes = bsdf.config.lobes;
  const poly<double> cosine = clamp_cosine(dot(axis, bsdf.point.to_viewer));
  const Direction3 reflected = reflect(bsdf.point.to_viewer, axis, cosine);
  const bool splits = lobes.smooth_specular() || lobes.transmissive();
  const FacetSplit split = splits ? split_at_facet(bsdf, cosine) : FacetSplit{};
  if (!lobes.transmissive()) return {reflected, mask(cn::mask_from_bits(0)), split, cosine};
  const mask through = way.specular & (choice >= bsdf.shares.specular * split.reflected_share);
  return {cn::select(through, transmit(bsdf, axis, reflected, cosine), reflected), through, split, cosine};
}

inline Departure depart(const Bsdf& bsdf, const WayToSample& way, const Direction3& axis,
                        const poly<double>& choice) {
  const Lobes& lobes = bsdf.config.lobes;
  const Departure from_sphere{axis, mask(cn::mask_from_bits(0)), {}, {}};
  if (!lobes.specular() && !lobes.coat) return from_sphere;
  const Departure by_facet = unless_absent(
      bsdf.config, [&] { return way.specular | way.coat; }, from_sphere,
      [&] { return depart_from_facet(bsdf, way, axis, choice); });
  if (!lobes.cosine() && !lobes.sheen) return by_facet;
  const mask behind = lobes.frosted_sheets() ? goes_behind(bsdf, way, choice) : mask();
  const Direction3 of_sphere = lobes.frosted_sheets() ? cn::select(behind, axis * -1.0, axis) : axis;
  return {cn::select(way.sphere, of_sphere, by_facet.direction),
          lobes.frosted_sheets() ? by_facet.transmits | behind : by_facet.transmits, by_facet.split,
          by_facet.cosine};
}

/// A sample of a lobe that reflects or refracts into a single direction.
struct DeltaSample {
  Rgb weight;
  mask chosen;
};

inline DeltaSample smooth_base_sample(const Bsdf& bsdf, const WayToSample& way, const Departure& departure) {
  const Lobes& lobes = bsdf.config.lobes;
  const FacetSplit& split = departure.split;
  const mask chosen = chooses_mirror(bsdf, way);
  const bool shared = lobes.ways_to_sample() > 1;
  if (!lobes.transmissive() && !shared) return {split.reflectance, chosen};
  const poly<double> branch =
      lobes.transmissive()
          ? cn::select(departure.transmits, 1.0 - split.reflected_share, split.reflected_share)
          : poly<double>(1.0);
  const poly<double> probability = !shared                ? branch
                                   : lobes.transmissive() ? branch * bsdf.shares.specular
                                                          : bsdf.shares.specular;
  const Rgb value = lobes.transmissive()
                        ? cn::select(departure.transmits, split.transmittance, split.reflectance)
                        : split.reflectance;
  return {value * (1.0 / keep_positive(probability)), chosen};
}

inline DeltaSample smooth_coat_sample(const Bsdf& bsdf, const WayToSample& way, const Departure& departure) {
  const CoatLayer& coat = bsdf.terms.coat;
  const poly<double> weight = coat.weight * coat_fresnel(departure.cosine) / keep_positive(bsdf.shares.coat);
  return {{weight, weight, weight}, way.coat & (coat.alpha == 0.0)};
}

/// Replaces the sample where a PE has chosen a single direction.
inline BsdfSample with_delta(const BsdfSample& sample, const DeltaSample& delta) {
  return {sample.direction, cn::select(delta.chosen, delta.weight, sample.weight),
          cn::select(delta.chosen, poly<double>(0.0), sample.pdf), sample.is_delta | delta.chosen,
          sample.transmits};
}

inline void assign_all(BsdfSample& to, const BsdfSample& from) {
  assign(to.weight, from.weight);
  to.pdf.assign_all_lanes(from.pdf);
  to.is_delta = from.is_delta;
}

inline Rgb below_layers(const Lobes& lobes, const Rgb& weight, const LayerTransmittance& layers) {
  const Rgb below_sheen = lobes.sheen ? weight * layers.sheen : weight;
  return lobes.coat ? below_sheen * layers.coat : below_sheen;
}

inline BsdfSample only_diffuse_sample(const Bsdf& bsdf, const UniformPair& uniform) {
  const mask none(cn::mask_from_bits(0));
  const Direction3 direction = sample_cosine(bsdf.point.normal, uniform.u, uniform.v);
  const Rgb& color = bsdf.terms.cosine.diffuse;
  if (!bsdf.config.diffuse_pdf && !bsdf.config.shading_normals) return {direction, color, {}, none, none};
  const EvaluatedBsdf evaluated = evaluate(bsdf, direction);
  const Rgb weight =
      bsdf.config.shading_normals ? cn::select(evaluated.light.lit, color, Rgb{0.0, 0.0, 0.0}) : color;
  return {direction, weight, evaluated.value.pdf, none, none};
}

/// Only mirrors and smooth glass: there is nothing to evaluate.
inline BsdfSample only_delta_sample(const Bsdf& bsdf, const WayToSample& way, const Departure& departure) {
  const DeltaSample delta = smooth_base_sample(bsdf, way, departure);
  if (!bsdf.config.shading_normals)
    return {departure.direction, delta.weight, 0.0, way.specular, departure.transmits};
  const mask lit = light_side(bsdf, departure.direction).lit;
  return {departure.direction, cn::select(lit, delta.weight, Rgb{0.0, 0.0, 0.0}), 0.0, way.specular,
          departure.transmits};
}

/// Whether the direction is on the side that its way to sample meant. A facet may reflect to behind the
/// surface; such samples end the path, and densities leave them out.
inline mask on_meant_side(const Lobes& lobes, const Departure& departure, const LightSide& light) {
  if (!lobes.transmissive()) return light.lit;
  return light.lit & ((departure.transmits & light.transmits) | (!(departure.transmits | light.transmits)));
}

}  // namespace bsdf_detail

/// Samples the next direction. Lobes are chosen in proportion to estimates of their albedos, and the density
/// is the sum over all lobes that might have given the direction (one-sample multiple importance sampling).
/// @param choice uniform, independent of `uniform`; purely diffuse materials do not use it
inline BsdfSample sample_bsdf(const Bsdf& bsdf, const UniformPair& uniform, const poly<double>& choice) {
  using namespace bsdf_detail;
  const Lobes& lobes = bsdf.config.lobes;
  if (lobes.only_diffuse()) return only_diffuse_sample(bsdf, uniform);
  const WayToSample way = choose_way(bsdf, choice);
  const Departure departure = depart(bsdf, way, sample_axis(bsdf, way, uniform), choice);
  if (!lobes.evaluable()) return only_delta_sample(bsdf, way, departure);
  const EvaluatedBsdf found = evaluate(bsdf, departure.direction);
  const poly<double>& pdf = found.value.pdf;
  const poly<double> inverse = 1.0 / cn::select(pdf > 0.0, pdf, poly<double>(1.0));
  BsdfSample sample{departure.direction, found.value.value * inverse, pdf, mask(cn::mask_from_bits(0)),
                    departure.transmits};
  if (lobes.smooth_specular()) {
    DeltaSample delta = smooth_base_sample(bsdf, way, departure);
    assign(delta.weight, below_layers(lobes, delta.weight, found.layers));
    assign_all(sample, with_delta(sample, delta));
  }
  if (lobes.coat) assign_all(sample, with_delta(sample, smooth_coat_sample(bsdf, way, departure)));
  const mask usable = on_meant_side(lobes, departure, found.light);
  return {sample.direction, cn::select(usable, sample.weight, Rgb{0.0, 0.0, 0.0}),
          cn::select(usable, sample.pdf, poly<double>(0.0)), sample.is_delta, sample.transmits};
}

/// eta^2 where the sample is refracted, else 1. Throughput times the product of these along a path does not
/// shrink because the path is inside glass; Russian roulette should look at it.
inline poly<double> roulette_factor(const Bsdf& bsdf, const BsdfSample& sample) {
  const Lobes& lobes = bsdf.config.lobes;
  if (!lobes.transmissive()) return 1.0;
  const poly<double>& eta = bsdf.terms.specular.surface.eta;
  const mask refracts = lobes.thin_glass ? sample.transmits & !bsdf.material.thin : sample.transmits;
  return cn::select(refracts, eta * eta, poly<double>(1.0));
}

}  // namespace path_tracer
