#pragma once

#include "firmware/cn/language/control.hpp"
#include "firmware/path_tracer/records/records.hpp"

namespace path_tracer {

using cn::mask;
using cn::poly;
using Direction3 = vec3<poly<double>>;
using Point3 = vec3<poly<double>>;

inline constexpr double kPi = 3.14159265358979323846;

/// Scales a vector to unit length. A vector whose length is nearly 0 becomes `fallback`.
inline Direction3 normalize(const Direction3& v, const Direction3& fallback) {
  constexpr double kTooShort = 1e-30;
  const poly<double> length_squared = dot(v, v);
  const mask usable = length_squared > kTooShort;
  const poly<double> scale = 1.0 / cn::sqrt(cn::select(usable, length_squared, poly<double>(1.0)));
  return cn::select(usable, v * scale, fallback);
}

/// Samples directions with density cos / pi around a unit normal: the normal plus a point of the unit sphere,
/// which needs no tangents.
inline Direction3 sample_cosine(const Direction3& normal, const poly<double>& u, const poly<double>& v) {
  const poly<double> z = 1.0 - 2.0 * u;
  const poly<double> radius = cn::sqrt(1.0 - z * z);
  const cn::SineCosine angle = cn::sincos(2.0 * kPi * v);
  const Direction3 on_sphere{radius * angle.cosine, radius * angle.sine, z};
  return normalize(normal + on_sphere, normal);
}

/// Samples a triangle uniformly in area: the outer half of the parallelogram is folded back.
inline Point3 sample_triangle(const Point3& vertex, const Direction3& edge1, const Direction3& edge2,
                              const poly<double>& u, const poly<double>& v) {
  const mask outside = u + v > 1.0;
  const poly<double> a = cn::select(outside, 1.0 - u, u);
  const poly<double> b = cn::select(outside, 1.0 - v, v);
  return vertex + edge1 * a + edge2 * b;
}

/// Returns the first entry of a cumulative distribution that is above u. The control unit goes through the
/// mono table entry by entry.
inline poly<std::int32_t> sample_cdf(const double* cdf, int count, const poly<double>& u) {
  poly<std::int32_t> chosen = 0;
  for (int i = 0; i + 1 < count; ++i) {
    cn::issue(cn::InstructionClass::mono, 4);
    cn::poly_if(u >= cdf[i], [&] { chosen = i + 1; });
  }
  return chosen;
}

struct CdfEntry {
  poly<std::int32_t> entry;
  poly<double> rest;  ///< position of u within the entry, in [0, 1): uniform again
};

/// sample_cdf() that also returns the unused part of u. Rounding may let the last entry end below 1.
inline CdfEntry sample_cdf_stretched(const double* cdf, int count, const poly<double>& u) {
  if (count == 1) return {0, u};
  poly<std::int32_t> chosen = 0;
  poly<double> low = 0.0;
  poly<double> high = cdf[0];
  for (int i = 0; i + 1 < count; ++i) {
    cn::issue(cn::InstructionClass::mono, 4);
    cn::poly_if(u >= cdf[i], [&] {
      chosen = i + 1;
      low = cdf[i];
      high = cdf[i + 1];
    });
  }
  constexpr double kBelowOne = 1.0 - 0x1p-53;
  return {chosen, cn::min((u - low) / (high - low), poly<double>(kBelowOne))};
}

/// A class by its probability, then a light of the class, with the unused part of u. The control unit goes
/// through the classes, few however many lights there are.
/// @param cdf entry i: probability of classes 0..i
inline CdfEntry sample_light_class(const double* cdf, const LightClass* classes, int count,
                                   const poly<double>& u) {
  poly<double> low = 0.0;
  poly<double> high = cdf[0];
  poly<std::int32_t> first = classes[0].first;
  poly<double> lights = double(classes[0].count);
  for (int i = 0; i + 1 < count; ++i) {
    cn::issue(cn::InstructionClass::mono, 6);
    cn::poly_if(u >= cdf[i], [&] {
      low = cdf[i];
      high = cdf[i + 1];
      first = classes[i + 1].first;
      lights = double(classes[i + 1].count);
    });
  }
  const poly<double> place = (u - low) / (high - low) * lights;
  const poly<std::int32_t> light = cn::convert<std::int32_t>(cn::min(place, lights - 0.5));
  constexpr double kBelowOne = 1.0 - 0x1p-53;
  return {first + light, cn::min(place - cn::convert<double>(light), poly<double>(kBelowOne))};
}

}  // namespace path_tracer
