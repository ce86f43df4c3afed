#pragma once

#include <limits>

#include "firmware/cn/language/poly_pointer.hpp"
#include "firmware/path_tracer/records/tails.hpp"
#include "firmware/path_tracer/sampling/light_sampling.hpp"

/// Sampling lights without triangles. Fields of their LightRecords:
///
/// | field | point | distant | environment |
/// |---|---|---|---|
/// | vertex | position | | |
/// | edge1 | radiant intensity | irradiance of a surface that faces the light, if it were a point | lowest
/// longitude, its span, density for MIS | | edge2 | x, y: a direction of cosine c to the axis gets the share
/// clamp(x c + y)^2 | x: 1 - cosine of half the disk's angle | lowest cosine of the colatitude, its span | |
/// normal | axis of a spot, away from it | towards the light's middle | | | inverse_pdf | 1 / probability | 1
/// / probability | solid angle / probability |
namespace path_tracer {

struct ShapeSample {
  LightSample sample;         ///< weight: cosine at the lit point * density of positions / of directions
  vec3<poly<double>> colour;  ///< multiplies the weight
  poly<double> pdf;           ///< by solid angle; infinity where no segment can find the light
};

/// A direction at a small angle from `axis`, uniform in the cone's solid angle. The tangents need no branch
/// (Duff, Burgess, Christensen, Hery, Kensler, Liani, Villemin, "Building an Orthonormal Basis, Revisited",
/// JCGT 6(1), 2017).
/// @param rest 1 - cosine of the cone's half angle
inline Direction3 sample_cone(const Direction3& axis, const poly<double>& rest, const poly<double>& u,
                              const poly<double>& v) {
  const poly<double> below = u * rest;  // 1 - cosine
  const poly<double> sine = cn::sqrt(cn::max(below * (2.0 - below), poly<double>(0.0)));
  const cn::SineCosine around = cn::sincos(2.0 * kPi * v);
  const poly<double> sign = cn::select(axis.z < 0.0, poly<double>(-1.0), poly<double>(1.0));
  const poly<double> a = -1.0 / (sign + axis.z);
  const poly<double> b = axis.x * axis.y * a;
  const Direction3 tangent{1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x};
  const Direction3 bitangent{b, sign + axis.y * axis.y * a, -axis.y};
  return axis * (1.0 - below) + tangent * (sine * around.cosine) + bitangent * (sine * around.sine);
}

/// Light from a point, all around or in a cone with a smooth edge (glTF, KHR_lights_punctual, "Inner and
/// Outer Cone Angles").
inline ShapeSample sample_point_light(const cn::PolyPointer<LightRecord>& light, const Point3& position,
                                      const Direction3& normal) {
  const Direction3 to_light = light.get(&LightRecord::vertex) - position;
  const poly<double> distance_squared = cn::max(dot(to_light, to_light), poly<double>(kNotZero));
  const poly<double> distance = cn::sqrt(distance_squared);
  const Direction3 cone = light.get(&LightRecord::edge2);
  const poly<double> cosine = -dot(to_light, light.get(&LightRecord::normal)) / distance;
  const poly<double> inside =
      cn::min(cn::max(cosine * cone.x + cone.y, poly<double>(0.0)), poly<double>(1.0));
  const poly<double> weight = dot(to_light, normal) / distance * (inside * inside) / distance_squared;
  return {{to_light, weight}, light.get(&LightRecord::edge1), std::numeric_limits<double>::infinity()};
}

/// Light from a disk in the sky, or parallel light.
inline ShapeSample sample_distant_light(const cn::PolyPointer<LightRecord>& light, const Direction3& normal,
                                        const poly<double>& u, const poly<double>& v) {
  const Direction3 to_light =
      sample_cone(light.get(&LightRecord::normal), light.get(&LightRecord::edge2).x, u, v);
  return {{to_light, dot(to_light, normal)},
          light.get(&LightRecord::edge1),
          std::numeric_limits<double>::infinity()};
}

/// A direction of a part of the environment's image, uniform in its solid angle. What comes from there, the
/// ray looks up.
inline ShapeSample sample_environment(const cn::PolyPointer<LightRecord>& light,
                                      const EnvironmentImage& image, const Direction3& normal,
                                      const poly<double>& u, const poly<double>& v) {
  const Direction3 longitudes = light.get(&LightRecord::edge1);
  const Direction3 cosines = light.get(&LightRecord::edge2);
  const cn::SineCosine longitude = cn::sincos(longitudes.x + longitudes.y * u);
  const poly<double> up = cosines.x + cosines.y * v;
  const poly<double> across = cn::sqrt(cn::max((1.0 - up) * (1.0 + up), poly<double>(0.0)));
  const poly<double> right = across * longitude.sine;
  const poly<double> back = -across * longitude.cosine;
  const auto along = [&](const vec3<double>& axis, const poly<double>& share) {
    return Direction3{share * axis.x, share * axis.y, share * axis.z};
  };
  const Direction3 to_light =
      along(image.x_axis, right) + along(image.y_axis, up) + along(image.z_axis, back);
  const poly<double> one = 1.0;
  return {{to_light, dot(to_light, normal)}, {one, one, one}, longitudes.z};
}

}  // namespace path_tracer
