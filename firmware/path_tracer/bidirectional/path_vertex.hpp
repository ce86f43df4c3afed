#pragma once

#include "firmware/path_tracer/kernels/shade.hpp"
#include "firmware/path_tracer/records/pair_records.hpp"

/// A vertex of either path, seen from the lens's side and from the light's. Both sides ask the BSDF for what
/// an eye path would find: radiance that arrives from the light's side and leaves to the lens's. So a light
/// path needs no BSDF of its own, whatever is not symmetrical in it: refraction, which compresses radiance,
/// normals of shading, and where these give way to the triangle's (Veach, dissertation, Stanford, 1997,
/// chapter 5). A light path has instead the ratio of the cosines that turn areas into directions.
namespace path_tracer {

struct PathVertex {
  Point3 position;
  Direction3 normal;          ///< of the triangle, on its front
  Direction3 shading_normal;  ///< likewise; read only with BsdfConfig::shading_normals
  Direction3 to_previous;
  Rgb throughput;     ///< of the segment that arrived
  Material material;  ///< seen from the front
  Rgb absorption;     ///< behind the surface, per unit of length
  poly<double> inverse_pdf;
  poly<double> distance_squared;
  poly<double> connects_before;
  poly<double> light_sum;
  poly<std::int32_t> face;
};

inline BsdfConfig pair_bsdf_config(const Features& features, bool skips_absent_lobes) {
  BsdfConfig config;
  config.lobes = features.lobes;
  config.shading_normals = features.shading_normals();
  config.diffuse_pdf = true;
  config.skips_absent_lobes = skips_absent_lobes;
  return config;
}

inline mask is_ray(const poly<std::int32_t>& ray, PairRay wanted) {
  return ray == poly<std::int32_t>(static_cast<std::int32_t>(wanted));
}

inline PolyPointer<PassingRecord> passing_of(const PolyPointer<PairRecord>& pair, const PairSizes& sizes) {
  return tail<PassingRecord>(pair, sizes.passing);
}

/// Where a surface has let the slot's ray through. Scenes without coverage do not ask.
inline mask has_passed(const PolyPointer<PairRecord>& pair, const PairSizes& sizes) {
  if (sizes.passing == 0) return mask(cn::mask_from_bits(0));
  return passing_of(pair, sizes).get(&PassingRecord::passes) != 0;
}

/// The slot's next ray begins at a vertex.
inline void forget_passing(const PolyPointer<PairRecord>& pair, const PairSizes& sizes) {
  const PolyPointer<PassingRecord> passing = passing_of(pair, sizes);
  passing.set(&PassingRecord::distance, poly<double>(0.0));
  passing.set(&PassingRecord::passes, poly<std::int32_t>(0));
}

inline poly<double> one_or_none(const mask& condition) {
  return cn::select(condition, poly<double>(1.0), poly<double>(0.0));
}

inline void store_vertex(const PathVertex& vertex, const PairSizes& sizes, const Lobes& lobes,
                         const PolyPointer<PathVertexRecord>& to) {
  to.set(&PathVertexRecord::position, vertex.position);
  to.set(&PathVertexRecord::normal, vertex.normal);
  to.set(&PathVertexRecord::to_previous, vertex.to_previous);
  to.set(&PathVertexRecord::throughput, vertex.throughput);
  to.set(&PathVertexRecord::base_color, vertex.material.base_color);
  to.set(&PathVertexRecord::inverse_pdf, vertex.inverse_pdf);
  to.set(&PathVertexRecord::distance_squared, vertex.distance_squared);
  to.set(&PathVertexRecord::connects_before, vertex.connects_before);
  to.set(&PathVertexRecord::light_sum, vertex.light_sum);
  to.set(&PathVertexRecord::face, vertex.face);
  if (sizes.normal != 0)
    tail<VertexNormalRecord>(to, sizes.normal).set(&VertexNormalRecord::normal, vertex.shading_normal);
  if (sizes.material == 0) return;
  const auto record = tail<VertexMaterialRecord>(to, sizes.material);
  const Material& material = vertex.material;
  record.set(&VertexMaterialRecord::metallic, material.metallic);
  record.set(&VertexMaterialRecord::roughness, material.roughness);
  record.set(&VertexMaterialRecord::f0, material.f0);
  record.set(&VertexMaterialRecord::f90, material.f90);
  record.set(&VertexMaterialRecord::transmission, material.transmission);
  record.set(&VertexMaterialRecord::ior, material.eta);
  if (lobes.thin_glass) record.set(&VertexMaterialRecord::thin, one_or_none(material.thin));
  if (lobes.coat) {
    record.set(&VertexMaterialRecord::coat, material.coat);
    record.set(&VertexMaterialRecord::coat_roughness, material.coat_roughness);
  }
  if (lobes.sheen) {
    record.set(&VertexMaterialRecord::sheen_color, material.sheen_color);
    record.set(&VertexMaterialRecord::sheen_roughness, material.sheen_roughness);
  }
  if (lobes.varnish_tint) record.set(&VertexMaterialRecord::varnish_tint, material.varnish_tint);
  if (lobes.transmission_tint)
    record.set(&VertexMaterialRecord::transmission_color, material.transmission_color);
  if (lobes.absorption) record.set(&VertexMaterialRecord::absorption, vertex.absorption);
}

inline PathVertex load_vertex(const PairSizes& sizes, const Lobes& lobes,
                              const PolyPointer<PathVertexRecord>& from) {
  PathVertex vertex{};
  bsdf_detail::assign(vertex.position, from.get(&PathVertexRecord::position));
  bsdf_detail::assign(vertex.normal, from.get(&PathVertexRecord::normal));
  bsdf_detail::assign(vertex.to_previous, from.get(&PathVertexRecord::to_previous));
  bsdf_detail::assign(vertex.throughput, from.get(&PathVertexRecord::throughput));
  bsdf_detail::assign(vertex.material.base_color, from.get(&PathVertexRecord::base_color));
  vertex.inverse_pdf.assign_all_lanes(from.get(&PathVertexRecord::inverse_pdf));
  vertex.distance_squared.assign_all_lanes(from.get(&PathVertexRecord::distance_squared));
  vertex.connects_before.assign_all_lanes(from.get(&PathVertexRecord::connects_before));
  vertex.light_sum.assign_all_lanes(from.get(&PathVertexRecord::light_sum));
  vertex.face.assign_all_lanes(from.get(&PathVertexRecord::face));
  if (sizes.normal != 0)
    bsdf_detail::assign(vertex.shading_normal,
                        tail<VertexNormalRecord>(from, sizes.normal).get(&VertexNormalRecord::normal));
  if (sizes.material == 0) return vertex;
  const auto record = tail<VertexMaterialRecord>(from, sizes.material);
  Material& material = vertex.material;
  material.metallic.assign_all_lanes(record.get(&VertexMaterialRecord::metallic));
  material.roughness.assign_all_lanes(record.get(&VertexMaterialRecord::roughness));
  material.f0.assign_all_lanes(record.get(&VertexMaterialRecord::f0));
  material.f90.assign_all_lanes(record.get(&VertexMaterialRecord::f90));
  material.transmission.assign_all_lanes(record.get(&VertexMaterialRecord::transmission));
  material.eta.assign_all_lanes(record.get(&VertexMaterialRecord::ior));
  if (lobes.thin_glass) material.thin = record.get(&VertexMaterialRecord::thin) > 0.0;
  if (lobes.coat) {
    material.coat.assign_all_lanes(record.get(&VertexMaterialRecord::coat));
    material.coat_roughness.assign_all_lanes(record.get(&VertexMaterialRecord::coat_roughness));
  }
  if (lobes.sheen) {
    bsdf_detail::assign(material.sheen_color, record.get(&VertexMaterialRecord::sheen_color));
    material.sheen_roughness.assign_all_lanes(record.get(&VertexMaterialRecord::sheen_roughness));
  }
  if (lobes.varnish_tint)
    bsdf_detail::assign(material.varnish_tint, record.get(&VertexMaterialRecord::varnish_tint));
  if (lobes.transmission_tint)
    bsdf_detail::assign(material.transmission_color, record.get(&VertexMaterialRecord::transmission_color));
  if (lobes.absorption) bsdf_detail::assign(vertex.absorption, record.get(&VertexMaterialRecord::absorption));
  return vertex;
}

/// The BSDF for paths that come from `viewer`.
inline Bsdf bsdf_from(const BsdfConfig& config, const PathVertex& vertex, const Direction3& viewer) {
  const mask front = dot(vertex.normal, viewer) > 0.0;
  const Direction3 normal = cn::select(front, vertex.normal, vertex.normal * -1.0);
  ShadingPoint point{normal, normal, viewer};
  if (config.shading_normals) {
    const Direction3 facing = cn::select(front, vertex.shading_normal, vertex.shading_normal * -1.0);
    bsdf_detail::assign(point.normal, cn::select(dot(facing, viewer) > kLeastCosine, facing, normal));
  }
  if (!config.lobes.transmissive()) return prepare_bsdf(config, vertex.material, point);
  Material material = vertex.material;
  const mask enters = config.lobes.thin_glass ? front | material.thin : front;
  material.eta.assign_all_lanes(cn::select(enters, material.eta, 1.0 / material.eta));
  return prepare_bsdf(config, material, point);
}

/// What a vertex does with light between two directions.
struct Scattering {
  Rgb value;                  ///< BSDF * cosine of the light, for radiance
  poly<double> pdf_to_light;  ///< of an eye path that comes from the other direction, by solid angle
  poly<double> pdf_to_eye;    ///< of a light path, likewise
};

inline Scattering scatter_between(const BsdfConfig& config, const PathVertex& vertex,
                                  const Direction3& to_eye, const Direction3& to_light) {
  const BsdfValue seen = evaluate_bsdf(bsdf_from(config, vertex, to_eye), to_light);
  return {seen.value, seen.pdf, evaluate_bsdf(bsdf_from(config, vertex, to_light), to_eye).pdf};
}

/// What a light path has in place of the light's cosine: the ratio of cosines with the triangle's normal.
inline poly<double> cosine_ratio(const PathVertex& vertex, const Direction3& to_eye,
                                 const Direction3& to_light) {
  return cn::abs(dot(vertex.normal, to_eye)) /
         cn::max(cn::abs(dot(vertex.normal, to_light)), poly<double>(kLeastCosine));
}

/// What is left of light that leaves the vertex through the body behind its surface. As eye paths have it,
/// the surface at which they arrive absorbs.
inline Rgb let_through(const Lobes& lobes, const PathVertex& vertex, const Direction3& to_eye,
                       const poly<double>& distance) {
  const poly<double> one = 1.0;
  if (!lobes.absorption) return {one, one, one};
  return cn::select(dot(vertex.normal, to_eye) < 0.0, transmittance(vertex.absorption, distance),
                    Rgb{one, one, one});
}

/// Where a surface scatters otherwise than into single directions.
inline mask scatters_widely(const Bsdf& bsdf) {
  const Lobes& lobes = bsdf.config.lobes;
  mask wide(
      cn::mask_from_bits(lobes.cosine() || lobes.rough_specular() || lobes.coat || lobes.sheen ? 0xff : 0));
  if (!lobes.smooth_specular() && !lobes.coat) return wide;
  const BsdfTerms& terms = bsdf.terms;
  wide = mask(cn::mask_from_bits(0));
  if (lobes.diffuse) wide = wide | (largest_channel(terms.cosine.diffuse) > 0.0);
  if (lobes.glossy) wide = wide | (largest_channel(terms.cosine.multiple) > 0.0);
  if (lobes.frosted_sheets()) wide = wide | (largest_channel(terms.cosine.behind) > 0.0);
  if (lobes.rough_specular()) wide = wide | (terms.specular.is_present(lobes) & (terms.specular.alpha > 0.0));
  if (lobes.coat) wide = wide | ((bsdf.material.coat > 0.0) & (terms.coat.alpha > 0.0));
  if (lobes.sheen) wide = wide | (largest_channel(bsdf.material.sheen_color) > 0.0);
  return wide;
}

/// Where light may pass the surface.
inline mask passes_light(const Lobes& lobes, const Material& material) {
  if (!lobes.transmissive()) return mask(cn::mask_from_bits(0));
  return material.transmission > 0.0;
}

}  // namespace path_tracer
