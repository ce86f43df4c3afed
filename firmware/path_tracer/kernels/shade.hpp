#pragma once

#include "firmware/path_tracer/kernels/coverage.hpp"
#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/kernels/outside.hpp"
#include "firmware/path_tracer/kernels/places.hpp"
#include "firmware/path_tracer/kernels/textures.hpp"
#include "firmware/path_tracer/materials/absorption.hpp"
#include "firmware/path_tracer/materials/observe_lobes.hpp"
#include "firmware/path_tracer/materials/sample_bsdf.hpp"
#include "firmware/path_tracer/sampling/light_sampling.hpp"
#include "firmware/path_tracer/sampling/light_shapes.hpp"
#include "firmware/path_tracer/sampling/sampler.hpp"

/// What happens to a segment at the surface that it hit, in scenes that are not plain (records/features.hpp).
///
/// Light of emitting triangles arrives by shadow rays and by hits. For each light point y that a vertex x
/// sees, the weights of both add up to 1, so that the sum is unbiased whatever they are. They are the power
/// heuristic (Veach and Guibas, SIGGRAPH 1995) of two densities by solid angle: the BSDF's, and that of a
/// point uniform in the lights' areas. The latter stands for the density that shadow rays have in fact, which
/// is close to it for small or distant lights; near a large light it is lower, where hits do better.
namespace path_tracer {

/// A vertex of a path, as its next segment and its shadow ray need it.
struct ShadedVertex {
  Point3 position;
  Bsdf bsdf;
  /// Where hits and shadow rays share the light. Elsewhere it comes by shadow rays alone.
  mask shares_light;
  Rgb arrived;  ///< share of the vertex's light that the segment to the viewer lets through; read by dimmed()
};

/// Light of a vertex at the start of the segment that hit it.
inline Rgb dimmed(const ShadeArguments& arguments, const Rgb& light, const Rgb& arrived) {
  return arguments.features.lobes.absorption ? light * arrived : light;
}

/// Multiplies a material by what its textures show at the hit.
inline void apply_textures(const ShadeArguments& arguments, Material& material) {
  const TexturesAtHit textures(arguments.surface, arguments.sizes, arguments.look_ups);
  const TextureSlots& slots = arguments.features.textures;
  const auto multiply = [&](TextureSlot slot, poly<double>& field) {
    if (slots.looks_up(slot)) field.assign_all_lanes(field * textures.channel(slot));
  };
  if (slots.has(TextureSlot::reflectance))
    bsdf_detail::assign(material.base_color, material.base_color * textures.colour(TextureSlot::reflectance));
  multiply(TextureSlot::metallic, material.metallic);
  multiply(TextureSlot::roughness, material.roughness);
  if (slots.roughness_with_metallic)
    material.roughness.assign_all_lanes(material.roughness * textures.roughness_with_metallic());
  multiply(TextureSlot::transmission, material.transmission);
}

/// The BSDF's parameters at the hit, seen from the side that the segment arrived from.
inline Material read_material(const ShadeArguments& arguments, const mask& front) {
  const PolyPointer<SurfaceRecord>& surface = arguments.surface;
  const RecordSizes& sizes = arguments.sizes;
  const Lobes& lobes = arguments.features.lobes;
  Material material{};
  bsdf_detail::assign(material.base_color, surface.get(&SurfaceRecord::reflectance));
  if (lobes.specular()) {
    const auto record = tail<MaterialRecord>(surface, sizes.material);
    material.metallic.assign_all_lanes(record.get(&MaterialRecord::metallic));
    material.roughness.assign_all_lanes(record.get(&MaterialRecord::roughness));
    material.f0.assign_all_lanes(record.get(&MaterialRecord::f0));
    material.f90.assign_all_lanes(record.get(&MaterialRecord::f90));
    if (lobes.transmissive()) {
      const poly<double> ior = record.get(&MaterialRecord::ior);
      material.transmission.assign_all_lanes(record.get(&MaterialRecord::transmission));
      if (lobes.thin_glass) material.thin = record.get(&MaterialRecord::thin) != 0;
      const mask enters = lobes.thin_glass ? front | material.thin : front;
      material.eta.assign_all_lanes(cn::select(enters, ior, 1.0 / ior));
    }
  }
  if (lobes.varnish_tint)
    bsdf_detail::assign(material.varnish_tint,
                        tail<VarnishTintRecord>(surface, sizes.varnish_tint).get(&VarnishTintRecord::tint));
  if (lobes.coat) {
    const auto record = tail<CoatRecord>(surface, sizes.coat);
    material.coat.assign_all_lanes(record.get(&CoatRecord::strength));
    material.coat_roughness.assign_all_lanes(record.get(&CoatRecord::roughness));
  }
  if (lobes.sheen) {
    const auto record = tail<SheenRecord>(surface, sizes.sheen);
    bsdf_detail::assign(material.sheen_color, record.get(&SheenRecord::colour));
    material.sheen_roughness.assign_all_lanes(record.get(&SheenRecord::roughness));
  }
  if (arguments.features.textures.any()) apply_textures(arguments, material);
  if (lobes.transmission_tint) {
    const auto record = tail<TransmissionTintRecord>(surface, sizes.transmission_tint);
    bsdf_detail::assign(material.transmission_color,
                        cn::select(record.get(&TransmissionTintRecord::is_base) != 0, material.base_color,
                                   record.get(&TransmissionTintRecord::colour)));
  }
  return material;
}

/// Whether the material reflects only diffusely.
inline mask is_diffuse(const Lobes& lobes, const Material& material) {
  mask diffuse(cn::mask_from_bits(0xff));
  if (lobes.specular()) diffuse = diffuse & (material.metallic == 0.0) & (material.f90 == 0.0);
  if (lobes.transmissive()) diffuse = diffuse & (material.transmission == 0.0);
  if (lobes.coat) diffuse = diffuse & (material.coat == 0.0);
  if (lobes.sheen) diffuse = diffuse & (largest_channel(material.sheen_color) == 0.0);
  return diffuse;
}

/// Density by solid angle of a point uniform in the lights' areas.
/// @param facing -cosine at the light * distance
/// @param inverse_pdf by area
inline poly<double> light_pdf(const poly<double>& distance_squared, const poly<double>& distance,
                              const poly<double>& facing, const poly<double>& inverse_pdf) {
  return distance_squared * distance / (facing * inverse_pdf);
}

/// The share of the emission that counts where the segment hit a light.
inline poly<double> weight_of_hit(const ShadeArguments& arguments, const Direction3& normal) {
  if (!arguments.casts_shadow_rays) return 1.0;
  const poly<double> pdf = tail<DirectionRecord>(arguments.path).get(&DirectionRecord::pdf);
  const mask counts = pdf > 0.0;
  const poly<double> none = 0.0;
  if (arguments.sizes.aim == RecordSizes::kNone) return cn::select(counts, poly<double>(1.0), none);
  const auto arrival = tail<ArrivalRecord>(arguments.hit);
  poly<double> distance = arrival.get(&ArrivalRecord::distance);
  if (arguments.sizes.has_passed)
    distance.assign_all_lanes(distance + passed_behind(arguments.path).get(&PassedRecord::distance));
  const poly<double> facing = -dot(arrival.get(&ArrivalRecord::direction), normal) * distance;
  const poly<double> inverse_pdf =
      tail<AimRecord>(arguments.surface, arguments.sizes.aim).get(&AimRecord::inverse_pdf);
  const poly<double> other = light_pdf(distance * distance, distance, facing, inverse_pdf);
  return cn::select(counts, power_heuristic(cn::select(counts, pdf, poly<double>(1.0)), other), none);
}

/// Takes, where the light has no triangle, the sample of its kind.
inline void sample_other_shapes(const ShadeArguments& arguments, const ShadedVertex& vertex,
                                ShapeSample& chosen) {
  const PolyPointer<LightRecord>& light = arguments.light;
  const LightKinds& lights = arguments.features.lights;
  const Direction3& normal = vertex.bsdf.point.geometric_normal;
  const poly<double> u = arguments.path.get(&PathRecord::light_u);
  const poly<double> v = arguments.path.get(&PathRecord::light_v);
  const poly<std::int32_t> shape = light.get(&LightRecord::shape);
  const auto take_where = [&](LightShape wanted, const auto& sample) {
    cn::poly_if_any(shape == static_cast<std::int32_t>(wanted), [&] { chosen = sample(); });
  };
  if (lights.points)
    take_where(LightShape::point, [&] { return sample_point_light(light, vertex.position, normal); });
  if (lights.distant)
    take_where(LightShape::distant, [&] { return sample_distant_light(light, normal, u, v); });
  if (lights.environment)
    take_where(LightShape::environment,
               [&] { return sample_environment(light, arguments.image, normal, u, v); });
}

/// Keeps what the choices along a shadow ray depend on.
inline void keep_shadow_numbers(const ShadeArguments& arguments) {
  const auto numbers = tail<ShadowNumbersRecord>(arguments.lighting);
  numbers.set(&ShadowNumbersRecord::pixel, arguments.path.get(&PathRecord::pixel));
  numbers.set(&ShadowNumbersRecord::sample, arguments.path.get(&PathRecord::sample));
  numbers.set(&ShadowNumbersRecord::depth, arguments.path.get(&PathRecord::depth));
}

/// The face at which a shadow ray's search may end. What lets a shadow ray through does not end it, so in
/// scenes with coverage it looks for the nearest hit, as it does for lights without triangles.
inline poly<std::int32_t> searched_face(const ShadeArguments& arguments,
                                        const poly<std::int32_t>& light_face) {
  if (arguments.features.coverage) return kNoFace;
  if (!arguments.features.lights.without_triangles()) return light_face;
  return cn::max(light_face, poly<std::int32_t>(kNoFace));
}

/// Aims a shadow ray and records what it contributes if it reaches its light.
inline void aim(const ShadeArguments& arguments, const ShadedVertex& vertex, const mask& wants_light) {
  const PolyPointer<LightRecord>& light = arguments.light;
  const LightSurface light_surface{light.get(&LightRecord::vertex), light.get(&LightRecord::edge1),
                                   light.get(&LightRecord::edge2), light.get(&LightRecord::normal)};
  const Direction3& normal = vertex.bsdf.point.geometric_normal;
  const LightKinds& lights = arguments.features.lights;
  ShapeSample chosen{
      lights.surfaces ? sample_light(arguments.light_sampling, light_surface, light.get(&LightRecord::shape),
                                     vertex.position, normal, arguments.path.get(&PathRecord::light_u),
                                     arguments.path.get(&PathRecord::light_v))
                      : LightSample{{0.0, 0.0, 0.0}, 0.0},
      {1.0, 1.0, 1.0},
      0.0};
  if (lights.without_triangles()) sample_other_shapes(arguments, vertex, chosen);
  const LightSample& sample = chosen.sample;
  const mask facing = sample.weight > 0.0;
  const poly<double> inverse_pdf = light.get(&LightRecord::inverse_pdf);
  const poly<double> distance_squared = dot(sample.to_light, sample.to_light);
  const poly<double> distance = cn::sqrt(distance_squared);
  const Direction3 to_light =
      cn::select(facing, sample.to_light * (1.0 / cn::select(facing, distance, poly<double>(1.0))), normal);
  const BsdfValue value = evaluate_bsdf(vertex.bsdf, to_light);
  poly<double> scale =
      cn::select(facing, sample.weight * inverse_pdf / dot(to_light, normal), poly<double>(0.0));
  if (arguments.features.multiple_importance) {
    poly<double> here =
        light_pdf(distance_squared, distance, -dot(sample.to_light, light_surface.normal), inverse_pdf);
    if (lights.without_triangles()) here = cn::select(light.get(&LightRecord::face) < 0, chosen.pdf, here);
    const poly<double> weight = power_heuristic(cn::select(facing, here, poly<double>(1.0)), value.pdf);
    scale = scale * cn::select(vertex.shares_light, weight, poly<double>(1.0));
  }
  if (arguments.resamples_lights) scale = scale * arguments.resampling.get(&LightResampling::factor);
  Rgb contribution = dimmed(arguments, value.value * scale, vertex.arrived);
  if (lights.without_triangles()) contribution = contribution * chosen.colour;
  arguments.shadow_ray.set(&RayRecord::origin, vertex.position);
  arguments.shadow_ray.set(&RayRecord::direction, sample.to_light);
  arguments.shadow_ray.set(&RayRecord::left_face, arguments.surface.get(&SurfaceRecord::face));
  const poly<std::int32_t> light_face = light.get(&LightRecord::face);
  arguments.shadow_ray.set(&RayRecord::light_face, searched_face(arguments, light_face));
  arguments.lighting.set(&LightingRecord::weight, contribution);
  arguments.lighting.set(&LightingRecord::light_face, light.get(&LightRecord::face));
  if (arguments.is_in_layers)
    arguments.lighting.set(&LightingRecord::light,
                           light_number(arguments.light_place.read(), arguments.lights));
  if (arguments.features.blended_coverage) keep_shadow_numbers(arguments);
  cn::keep(arguments.cull_shadow_rays ? wants_light & (largest_channel(contribution) > 0.0) : wants_light,
           *arguments.casts);
}

/// Absorption of the segment that arrives, if it went through the body of the surface that it hit. Empty in
/// scenes without absorption.
inline Rgb absorb(const ShadeArguments& arguments, const mask& front) {
  if (!arguments.features.lobes.absorption) return {};
  const poly<double> one = 1.0;
  const Rgb coefficient = tail<AbsorptionRecord>(arguments.surface, arguments.sizes.absorption)
                              .get(&AbsorptionRecord::coefficient);
  const poly<double> distance = tail<ArrivalRecord>(arguments.hit).get(&ArrivalRecord::distance);
  return cn::select(front, Rgb{one, one, one}, transmittance(coefficient, distance));
}

/// The normal that the triangle's normal texture says (glTF 2.0, section 3.9.3). The tangent is turned into
/// the plane of `normal`, as MikkTSpace does: https://github.com/mmikk/MikkTSpace.
/// @param normal without the texture, on the front
inline Direction3 mapped_normal(const ShadeArguments& arguments, const Point3& position,
                                const Direction3& normal) {
  const auto record = tail<TangentRecord>(arguments.surface, arguments.sizes.tangent);
  const Rgb texel =
      TexturesAtHit(arguments.surface, arguments.sizes, arguments.look_ups).linear(TextureSlot::normal);
  Direction3 in_plane = record.get(&TangentRecord::tangent);
  if (arguments.features.tangents) {
    const auto slope = tail<TangentSlopeRecord>(arguments.surface, arguments.sizes.tangent_slope);
    bsdf_detail::assign(in_plane, in_plane + slope.get(&TangentSlopeRecord::along_x) * position.x +
                                      slope.get(&TangentSlopeRecord::along_y) * position.y +
                                      slope.get(&TangentSlopeRecord::along_z) * position.z);
  }
  const Direction3 none{0.0, 0.0, 0.0};
  const Direction3 tangent = normalize(in_plane - normal * dot(in_plane, normal), none);
  const poly<double> x = (texel.x * 2.0 - 1.0) * record.get(&TangentRecord::x_scale);
  const poly<double> y = (texel.y * 2.0 - 1.0) * record.get(&TangentRecord::y_scale);
  return normalize(tangent * x + cross(normal, tangent) * y + normal * (texel.z * 2.0 - 1.0), normal);
}

/// The interpolated normal on the front. @param otherwise where it vanishes
inline Direction3 interpolated_normal(const ShadeArguments& arguments, const Point3& position,
                                      const Direction3& otherwise) {
  const auto record = tail<NormalRecord>(arguments.surface, arguments.sizes.normal);
  const Direction3 along = record.get(&NormalRecord::along_x) * position.x +
                           record.get(&NormalRecord::along_y) * position.y +
                           record.get(&NormalRecord::along_z) * position.z;
  return normalize(record.get(&NormalRecord::at_origin) + along, otherwise);
}

/// The normal of shading on the viewer's side. Where interpolation or a texture turns it away from the
/// viewer, it is that of the triangle: a surface that is seen is not seen from behind.
inline Direction3 shading_normal(const ShadeArguments& arguments, const Point3& position,
                                 const Direction3& normal, const mask& front, const Direction3& to_viewer) {
  if (!arguments.features.shading_normals()) return normal;
  Direction3 unit = arguments.features.normals ? interpolated_normal(arguments, position, normal)
                                               : arguments.surface.get(&SurfaceRecord::normal);
  if (arguments.features.textures.has(TextureSlot::normal))
    bsdf_detail::assign(unit, mapped_normal(arguments, position, unit));
  const Direction3 facing = cn::select(front, unit, unit * -1.0);
  return cn::select(dot(facing, to_viewer) > kLeastCosine, facing, normal);
}

inline Bsdf bsdf_at_hit(const ShadeArguments& arguments, const Direction3& normal, const mask& front) {
  BsdfConfig config;
  config.shading_normals = arguments.features.shading_normals();
  config.lobes = arguments.features.lobes;
  config.diffuse_pdf = arguments.features.multiple_importance;
  config.skips_absent_lobes = arguments.skips_absent_lobes;
  const Direction3 to_viewer = tail<ArrivalRecord>(arguments.hit).get(&ArrivalRecord::direction) * -1.0;
  const Direction3 shading =
      shading_normal(arguments, arguments.hit.get(&HitRecord::position), normal, front, to_viewer);
  return prepare_bsdf(config, read_material(arguments, front), {shading, normal, to_viewer});
}

/// Where hits and shadow rays share the light.
inline mask shares_light(const ShadeArguments& arguments, const Material& material) {
  const mask all(cn::mask_from_bits(0xff));
  switch (arguments.estimator) {
    case Estimator::light:
      return !all;
    case Estimator::mis:
      return all;
    case Estimator::per_lobe:
      break;
  }
  return !is_diffuse(arguments.features.lobes, material);
}

/// Of mirrors and glass that lose nothing, the probability that a path goes on. Total reflection can hold a
/// path within a body of glass forever; so it ends after a hundred segments on average.
inline constexpr double kLosslessSurvival = 0.99;

/// The probability that roulette lets a path go on.
/// @param strongest channel of the sample's weight
inline poly<double> survival_of(const ShadeArguments& arguments, const poly<std::int32_t>& depth,
                                const BsdfSample& sample, const poly<double>& strongest) {
  poly<double> survival = cn::min(strongest, poly<double>(arguments.max_survival));
  if (arguments.features.lobes.smooth_specular())
    survival = cn::select(sample.is_delta, cn::min(survival, poly<double>(kLosslessSurvival)), survival);
  return cn::select(depth < arguments.roulette_start, poly<double>(1.0), survival);
}

/// Continues the path or ends it by Russian roulette.
inline void continue_at(const ShadeArguments& arguments, const ShadedVertex& vertex, const mask& hit) {
  const PolyPointer<PathRecord>& path = arguments.path;
  const poly<std::int32_t> pixel = path.get(&PathRecord::pixel);
  const poly<std::int32_t> number = path.get(&PathRecord::sample);
  const poly<std::int32_t> depth = path.get(&PathRecord::depth);
  const ScatterNumbers random = scatter_numbers(arguments.sampler, arguments.seed, pixel, number, depth);
  const poly<double> lobe = arguments.features.lobes.only_diffuse()
                                ? random.roulette
                                : lobe_number(arguments.sampler, arguments.seed, pixel, number, depth);
  const BsdfSample sample = sample_bsdf(vertex.bsdf, random.direction, lobe);

  const poly<double> strongest = largest_channel(sample.weight) * roulette_factor(vertex.bsdf, sample);
  const poly<double> survival = survival_of(arguments, depth, sample, strongest);
  const mask goes_on = hit & (strongest > 0.0) & (random.roulette < survival);
  const poly<double> inverse_survival = 1.0 / cn::select(goes_on, survival, poly<double>(1.0));
  const Rgb none{0.0, 0.0, 0.0};
  arguments.scatter.set(&ScatterRecord::position, vertex.position);
  arguments.scatter.set(&ScatterRecord::direction, sample.direction);
  arguments.scatter.set(
      &ScatterRecord::weight,
      cn::select(goes_on, dimmed(arguments, sample.weight, vertex.arrived) * inverse_survival, none));
  arguments.scatter.set(&ScatterRecord::face, arguments.surface.get(&SurfaceRecord::face));
  arguments.scatter.set(&ScatterRecord::ended,
                        cn::select(goes_on, poly<std::int32_t>(0), poly<std::int32_t>(1)));
  const poly<double> shared = cn::select(vertex.shares_light, sample.pdf, poly<double>(0.0));
  tail<DirectionRecord>(arguments.scatter)
      .set(&DirectionRecord::pdf,
           cn::select(sample.is_delta | sample.transmits, poly<double>(kInfinity), shared));
  if (arguments.sizes.has_passed)
    passed_behind(arguments.scatter).set(&PassedRecord::distance, poly<double>(0.0));
}

/// Whether what the segment hit lets it through. Scenes without coverage do not ask.
inline mask lets_segment_through(const ShadeArguments& arguments, const mask& hit, const mask& front) {
  const PolyPointer<PathRecord>& path = arguments.path;
  const auto chance = [&] {
    return coverage_number(arguments.sampler, arguments.seed, path.get(&PathRecord::pixel),
                           path.get(&PathRecord::sample), path.get(&PathRecord::depth),
                           arguments.surface.get(&SurfaceRecord::face));
  };
  return hit & lets_through(arguments.features, arguments.sizes, arguments.surface, arguments.look_ups, front,
                            chance);
}

/// Lets segments go straight on: their vertex neither emits nor scatters. How likely the direction was, and
/// how far the vertex is that chose it, goes on with them, so that hits of lights are weighed as if nothing
/// had been between.
inline void pass_on(const ShadeArguments& arguments, const mask& passes, const Rgb& arrived) {
  cn::keep(passes, *arguments.passes);
  cn::poly_if_any(passes, [&] {
    const auto arrival = tail<ArrivalRecord>(arguments.hit);
    const poly<double> zero = 0.0;
    const poly<double> one = 1.0;
    arguments.scatter.set(&ScatterRecord::radiance, Rgb{zero, zero, zero});
    arguments.scatter.set(&ScatterRecord::weight, dimmed(arguments, Rgb{one, one, one}, arrived));
    arguments.scatter.set(&ScatterRecord::direction, arrival.get(&ArrivalRecord::direction));
    arguments.scatter.set(&ScatterRecord::ended, poly<std::int32_t>(0));
    tail<DirectionRecord>(arguments.scatter)
        .set(&DirectionRecord::pdf, tail<DirectionRecord>(arguments.path).get(&DirectionRecord::pdf));
    if (arguments.sizes.has_passed)
      passed_behind(arguments.scatter)
          .set(&PassedRecord::distance, passed_behind(arguments.path).get(&PassedRecord::distance) +
                                            arrival.get(&ArrivalRecord::distance));
  });
}

inline void shade(const ShadeArguments& arguments) {
  const mask hit = arguments.hit.get(&HitRecord::hit) != 0;
  const mask front = arguments.hit.get(&HitRecord::front) != 0;
  const Direction3 surface_normal = arguments.surface.get(&SurfaceRecord::normal);
  const Direction3 normal = cn::select(front, surface_normal, surface_normal * -1.0);
  const Rgb arrived = absorb(arguments, front);

  const Rgb emission = emission_at_hit(arguments.surface, arguments.sizes, arguments.look_ups) *
                       weight_of_hit(arguments, normal);
  const Rgb none{0.0, 0.0, 0.0};
  const Rgb outside = radiance_from_outside(arguments);
  const Rgb inside = cn::select(front, dimmed(arguments, emission, arrived), none);
  arguments.scatter.set(&ScatterRecord::radiance, cn::select(hit, inside, outside));

  const Bsdf bsdf = bsdf_at_hit(arguments, normal, front);
  const ShadedVertex vertex{arguments.hit.get(&HitRecord::position), bsdf,
                            shares_light(arguments, bsdf.material), arrived};
  const bool has_coverage = arguments.features.coverage;
  const mask passes = has_coverage ? lets_segment_through(arguments, hit, front) : mask();
  const mask scatters = has_coverage ? hit & !passes : hit;
  continue_at(arguments, vertex, scatters);
  if (has_coverage) pass_on(arguments, passes, arrived);
  if (arguments.casts_shadow_rays) aim(arguments, vertex, scatters);
  observe_lobes(bsdf, front, scatters, *arguments.lobe_use);
}

}  // namespace path_tracer
