#pragma once

#include <limits>

#include "firmware/path_tracer/kernels/kernels.hpp"
#include "firmware/path_tracer/kernels/places.hpp"
#include "firmware/path_tracer/kernels/textures.hpp"

/// Light that arrives from outside the scene.
namespace path_tracer {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The power heuristic's weight of the first density, with exponent 2.
/// @param first positive, may be infinite
inline poly<double> power_heuristic(const poly<double>& first, const poly<double>& second) {
  const poly<double> ratio = second / first;
  return 1.0 / (1.0 + ratio * ratio);
}

inline poly<double> along_axis(const Direction3& direction, const vec3<double>& axis) {
  return direction.x * axis.x + direction.y * axis.y + direction.z * axis.z;
}

/// Where the texel of a direction is.
inline poly<MonoAddress> place_in_image(const EnvironmentImage& image, const Direction3& direction) {
  const poly<double> x = along_axis(direction, image.x_axis);
  const poly<double> y = along_axis(direction, image.y_axis);
  const poly<double> z = along_axis(direction, image.z_axis);
  const poly<double> longitude = cn::atan2(x, -z);
  const poly<double> colatitude = cn::atan2(cn::sqrt(x * x + z * z), y);
  const auto texel = [](const poly<double>& share, std::int32_t size) {
    const poly<double> inside =
        cn::max(poly<double>(0.0), cn::min(share * double(size), poly<double>(size - 0.5)));
    return cn::convert<std::int32_t>(inside);
  };
  const poly<std::int32_t> column = texel(longitude * (0.5 / kPi) + 0.5, image.width);
  const poly<std::int32_t> row = texel(colatitude * (1.0 / kPi), image.height);
  return place_of(image.texels, row * image.width + column, sizeof(EnvironmentTexel));
}

/// Finds the texel that a ray sees which hit nothing.
inline void look_up_environment(const EnvironmentLookUpArguments& arguments) {
  arguments.look_up.set(
      &EnvironmentLookUp::place,
      place_in_image(arguments.image, tail<ArrivalRecord>(arguments.hit).get(&ArrivalRecord::direction)));
}

inline Rgb radiance_of(const PolyPointer<EnvironmentTexel>& texel) {
  return {cn::convert<double>(texel.get(&EnvironmentTexel::red)),
          cn::convert<double>(texel.get(&EnvironmentTexel::green)),
          cn::convert<double>(texel.get(&EnvironmentTexel::blue))};
}

/// The part of the environment's image that a segment sees which hit nothing, weighed against shadow rays as
/// emission of triangles is.
inline Rgb radiance_of_image(const ShadeArguments& arguments) {
  const auto texel = tail<EnvironmentLookUp>(arguments.look_ups, arguments.sizes.environment)
                         .part(&EnvironmentLookUp::texel);
  const Rgb radiance = radiance_of(texel);
  if (!arguments.casts_shadow_rays) return radiance;
  const poly<double> pdf = tail<DirectionRecord>(arguments.path).get(&DirectionRecord::pdf);
  const mask counts = pdf > 0.0;
  const poly<double> none = 0.0;
  const poly<double> one = 1.0;
  if (!arguments.features.multiple_importance) return radiance * cn::select(counts, one, none);
  const poly<double> other = cn::convert<double>(texel.get(&EnvironmentTexel::pdf));
  return radiance * cn::select(counts, power_heuristic(cn::select(counts, pdf, one), other), none);
}

/// Suns that a segment sees which hit nothing. Where shadow rays find them, segments do not: a disk so small
/// is hardly ever hit.
inline Rgb radiance_of_suns(const ShadeArguments& arguments) {
  const Direction3 direction = tail<ArrivalRecord>(arguments.hit).get(&ArrivalRecord::direction);
  Rgb sum{0.0, 0.0, 0.0};
  for (int i = 0; i < arguments.sun_count; ++i) {
    const SunRecord& sun = arguments.suns[i];
    cn::issue(cn::InstructionClass::mono, 7);
    cn::poly_if(along_axis(direction, sun.direction) >= sun.cosine, [&] {
      sum = sum + Rgb{sun.radiance.x, sun.radiance.y, sun.radiance.z};
    });
  }
  if (!arguments.casts_shadow_rays) return sum;
  const poly<double> pdf = tail<DirectionRecord>(arguments.path).get(&DirectionRecord::pdf);
  return cn::select(pdf == kInfinity, sum, Rgb{0.0, 0.0, 0.0});
}

/// What a segment sees that hit nothing.
inline Rgb radiance_from_outside(const ShadeArguments& arguments) {
  const vec3<double>& constant = arguments.environment;
  Rgb radiance =
      arguments.features.environment ? Rgb{constant.x, constant.y, constant.z} : Rgb{0.0, 0.0, 0.0};
  if (arguments.features.lights.environment) radiance = radiance + radiance_of_image(arguments);
  if (arguments.features.lights.distant) radiance = radiance + radiance_of_suns(arguments);
  return radiance;
}

/// What a shadow ray brings from its light if that has no triangle, and whether it does: near lights stand at
/// the end of the ray's direction, the others behind everything.
struct LightWithoutTriangle {
  mask sees;
  Rgb radiance;
};
inline LightWithoutTriangle light_without_triangle(const IlluminateArguments& arguments) {
  const poly<std::int32_t> face = arguments.lighting.get(&LightingRecord::light_face);
  const mask hit = arguments.hit.get(&HitRecord::hit) != 0;
  const poly<double> distance = tail<ArrivalRecord>(arguments.hit).get(&ArrivalRecord::distance);
  const mask is_far = face < kNoFace;
  const mask is_blocked = hit & (is_far | (distance < 1.0));
  LightWithoutTriangle light{(face < 0) & !is_blocked, {1.0, 1.0, 1.0}};
  if (!arguments.features.lights.environment) return light;
  const auto texel = tail<EnvironmentLookUp>(arguments.look_ups, arguments.sizes.environment)
                         .part(&EnvironmentLookUp::texel);
  light.radiance = cn::select(face == kEnvironmentFace, radiance_of(texel), light.radiance);
  return light;
}

}  // namespace path_tracer
