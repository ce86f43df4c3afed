#pragma once

#include "firmware/path_tracer/bidirectional/pair_kernels.hpp"
#include "firmware/path_tracer/bidirectional/path_vertex.hpp"
#include "firmware/path_tracer/bidirectional/weights.hpp"
#include "firmware/path_tracer/sampling/light_shapes.hpp"

/// Lights as light paths leave them and eye paths sample them.
namespace path_tracer {

inline LightSurface light_surface_of(const PolyPointer<LightRecord>& light) {
  return {light.get(&LightRecord::vertex), light.get(&LightRecord::edge1), light.get(&LightRecord::edge2),
          light.get(&LightRecord::normal)};
}

inline mask is_shape(const PolyPointer<LightRecord>& light, LightShape shape) {
  return light.get(&LightRecord::shape) == poly<std::int32_t>(static_cast<std::int32_t>(shape));
}

/// The cosine at the edge of a spot's cone; -1 of light all around.
inline poly<double> cone_cosine(const PolyPointer<LightRecord>& light) {
  const Direction3 cone = light.get(&LightRecord::edge2);
  const mask is_spot = cone.x > 0.0;
  return cn::select(is_spot, -cone.y / cn::select(is_spot, cone.x, poly<double>(1.0)), poly<double>(-1.0));
}

/// Density of directions within the cone.
inline poly<double> cone_pdf(const poly<double>& cosine) {
  return 1.0 / (2.0 * kPi * (1.0 - cosine));
}

/// Density of light from far away across its direction.
inline double disk_pdf(const PairWorld& world) {
  return 1.0 / (kPi * world.radius * world.radius);
}

/// Density of directions by which connections find the disk of a sun; infinity of parallel light.
inline poly<double> disk_density(const PolyPointer<LightRecord>& light) {
  const poly<double> width = light.get(&LightRecord::edge2).x;  // 1 - cosine
  const mask is_disk = width > 0.0;
  const poly<double> solid_angle = cn::select(is_disk, width, poly<double>(1.0)) * (2.0 * kPi);
  return cn::select(is_disk, 1.0 / (solid_angle * light.get(&LightRecord::inverse_pdf)),
                    poly<double>(kInfinity));
}

/// A point of a light, as a vertex of an eye path samples it.
struct SampledLight {
  Direction3 to_light;  ///< of unit length
  Direction3 whole;     ///< the same, up to the light if it is near
  poly<double> scale;   ///< of BSDF * cosine * radiance; 0 if the light or the surface faces away
  Rgb colour;
  poly<double> hit_ratio;  ///< times the BSDF's density: P(e, x_0) / P(l, x_0); 0 if segments cannot hit it
  poly<double> emission_density;  ///< P(l, vertex)
};

/// @param normal on the side that the eye path came from
/// @param both_sides where light from behind passes
inline SampledLight sample_light_from(const ConnectArguments& arguments, const Point3& position,
                                      const Direction3& normal, const mask& both_sides) {
  const PolyPointer<LightRecord>& light = arguments.light;
  const LightKinds& lights = arguments.features.lights;
  const LightSurface surface = light_surface_of(light);
  const poly<double> u = arguments.pair.get(&PairRecord::light_u);
  const poly<double> v = arguments.pair.get(&PairRecord::light_v);
  const poly<double> one = 1.0;
  const poly<double> none = 0.0;
  const bool passes = arguments.features.lobes.transmissive();
  // All points of a light are on the same side of its plane, so its own normal serves where light may come
  // from either side of the surface.
  Direction3 used = passes ? cn::select(both_sides, surface.normal * -1.0, normal) : normal;
  ShapeSample chosen{lights.surfaces ? sample_light(arguments.light_sampling, surface,
                                                    light.get(&LightRecord::shape), position, used, u, v)
                                     : LightSample{{none, none, none}, none},
                     {one, one, one},
                     none};
  if (lights.without_triangles()) {
    const mask has_triangle = light.get(&LightRecord::face) >= 0;
    bsdf_detail::assign(used, cn::select(has_triangle, used, normal));
    const auto take_where = [&](LightShape wanted, const auto& sample) {
      cn::poly_if_any(is_shape(light, wanted), [&] { chosen = sample(); });
    };
    if (lights.points)
      take_where(LightShape::point, [&] { return sample_point_light(light, position, normal); });
    if (lights.distant)
      take_where(LightShape::distant, [&] {
        ShapeSample sample = sample_distant_light(light, normal, u, v);
        sample.pdf.assign_all_lanes(disk_density(light));
        return sample;
      });
    if (lights.environment)
      take_where(LightShape::environment,
                 [&] { return sample_environment(light, arguments.image, normal, u, v); });
  }
  const Direction3& whole = chosen.sample.to_light;
  const poly<double> distance_squared = cn::max(dot(whole, whole), poly<double>(kNotZero));
  const poly<double> distance = cn::sqrt(distance_squared);
  const Direction3 to_light = whole * (1.0 / distance);
  const poly<double> cosine_here = dot(to_light, used);
  const poly<double> ratio = chosen.sample.weight / cn::select(cosine_here == 0.0, one, cosine_here);
  const mask faces = (ratio > 0.0) & (passes ? both_sides | (cosine_here > 0.0) : cosine_here > 0.0);
  SampledLight sampled{
      to_light,      whole, cn::select(faces, ratio * light.get(&LightRecord::inverse_pdf), none),
      chosen.colour, none,  none};
  const poly<double> cosine_there = cn::max(-dot(to_light, surface.normal), none);
  const poly<double> inverse_square = 1.0 / distance_squared;
  sampled.hit_ratio.assign_all_lanes(cosine_there * light.get(&LightRecord::inverse_pdf) * inverse_square);
  sampled.emission_density.assign_all_lanes(cosine_there * (1.0 / kPi) * inverse_square);
  if (lights.without_triangles()) {
    const poly<std::int32_t> face = light.get(&LightRecord::face);
    const mask has_triangle = face >= 0;
    const mask is_far = face < poly<std::int32_t>(kNoFace);
    const poly<double> of_cone = cone_pdf(cone_cosine(light)) * inverse_square;
    const poly<double> without = cn::select(is_far, poly<double>(disk_pdf(arguments.world)), of_cone);
    sampled.hit_ratio.assign_all_lanes(
        cn::select(has_triangle, sampled.hit_ratio, 1.0 / cn::select(has_triangle, one, chosen.pdf)));
    sampled.emission_density.assign_all_lanes(cn::select(has_triangle, sampled.emission_density, without));
  }
  return sampled;
}

/// Where a light path begins.
struct LightStart {
  Point3 position;
  Direction3 direction;
  Rgb throughput;
  poly<double> pdf;      ///< of the direction, or of parallel light across it
  poly<double> hit_sum;  ///< S_0 of weights.hpp
  poly<std::int32_t> face;
  poly<std::int32_t> is_parallel;
};

/// On a triangle or rectangle, uniform in area; around the normal with the density of its radiance.
inline LightStart start_at_surface(const ConnectArguments& arguments, const UniformPair& direction) {
  const PolyPointer<LightRecord>& light = arguments.light;
  const LightSurface surface = light_surface_of(light);
  const poly<double> u = arguments.pair.get(&PairRecord::light_u);
  const poly<double> v = arguments.pair.get(&PairRecord::light_v);
  const Point3 in_rectangle = surface.vertex + surface.edge1 * u + surface.edge2 * v;
  const Point3 in_triangle = sample_triangle(surface.vertex, surface.edge1, surface.edge2, u, v);
  const Direction3 chosen = sample_cosine(surface.normal, direction.u, direction.v);
  const poly<double> cosine = cn::max(dot(chosen, surface.normal), poly<double>(kLeastCosine));
  const poly<double> inverse_pdf = light.get(&LightRecord::inverse_pdf);
  return {cn::select(is_shape(light, LightShape::rectangle), in_rectangle, in_triangle),
          chosen,
          arguments.emission.get(&LightEmissionRecord::radiance) * (inverse_pdf * kPi),
          cosine * (1.0 / kPi),
          squared(cosine * inverse_pdf),
          light.get(&LightRecord::face),
          0};
}

/// From a point, uniform in the cone that it lights.
inline LightStart start_at_point(const ConnectArguments& arguments, const UniformPair& direction) {
  const PolyPointer<LightRecord>& light = arguments.light;
  const Direction3 axis = normalize(light.get(&LightRecord::normal), {0.0, 0.0, 1.0});
  const poly<double> edge = cone_cosine(light);
  const Direction3 chosen = sample_cone(axis, 1.0 - edge, direction.u, direction.v);
  const Direction3 cone = light.get(&LightRecord::edge2);
  const poly<double> inside =
      cn::min(cn::max(dot(chosen, axis) * cone.x + cone.y, poly<double>(0.0)), poly<double>(1.0));
  const poly<double> pdf = cone_pdf(edge);
  return {light.get(&LightRecord::vertex),
          chosen,
          light.get(&LightRecord::edge1) * (inside * inside * light.get(&LightRecord::inverse_pdf) / pdf),
          pdf,
          0.0,
          kNoFace,
          0};
}

/// From far away, through a disk that covers the scene.
/// @param hit_sum S_0
inline LightStart start_far_away(const ConnectArguments& arguments, const ShapeSample& sample,
                                 const UniformPair& on_disk, const poly<double>& hit_sum) {
  const PairWorld& world = arguments.world;
  const Direction3& to_light = sample.sample.to_light;
  const Tangents frame = tangents(to_light);
  const poly<double> radius = cn::sqrt(on_disk.u) * world.radius;
  const cn::SineCosine angle = cn::sincos(2.0 * kPi * on_disk.v);
  const Direction3 away =
      to_light * world.radius + frame.first * (radius * angle.cosine) + frame.second * (radius * angle.sine);
  const double pdf = disk_pdf(world);
  return {away + world.centre,
          to_light * -1.0,
          sample.colour * (arguments.light.get(&LightRecord::inverse_pdf) * (1.0 / pdf)),
          pdf,
          hit_sum,
          arguments.light.get(&LightRecord::face),
          1};
}

inline LightStart start_at_light(const ConnectArguments& arguments) {
  const PolyPointer<PairRecord>& pair = arguments.pair;
  const PolyPointer<LightRecord>& light = arguments.light;
  const LightKinds& lights = arguments.features.lights;
  const poly<double> u = pair.get(&PairRecord::light_u);
  const poly<double> v = pair.get(&PairRecord::light_v);
  const UniformPair direction = emission_numbers(arguments.sampler, arguments.seed,
                                                 pair.get(&PairRecord::pixel), pair.get(&PairRecord::sample));
  LightStart start = start_at_surface(arguments, direction);
  if (!lights.without_triangles()) return start;
  const auto take_where = [&](LightShape wanted, const auto& other) {
    cn::poly_if_any(is_shape(light, wanted), [&] { start = other(); });
  };
  if (lights.points) take_where(LightShape::point, [&] { return start_at_point(arguments, direction); });
  const Direction3 any{0.0, 0.0, 1.0};
  if (lights.distant)
    take_where(LightShape::distant, [&] {
      return start_far_away(arguments, sample_distant_light(light, any, u, v), direction,
                            squared(1.0 / disk_density(light)));
    });
  if (lights.environment)
    take_where(LightShape::environment, [&] {
      const ShapeSample sample = sample_environment(light, arguments.image, any, u, v);
      return start_far_away(arguments, sample, direction, squared(1.0 / sample.pdf));
    });
  return start;
}

}  // namespace path_tracer
