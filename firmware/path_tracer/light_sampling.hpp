#pragma once

#include "firmware/path_tracer/sampling.hpp"

/// Choosing a point of a light as seen from a point that it may light.
namespace path_tracer {

/// The fields of a LightRecord that say where it is.
struct LightSurface {
  Point3 vertex;
  Direction3 edge1;
  Direction3 edge2;
  Direction3 normal;
};

struct LightSample {
  Direction3 to_light;  ///< from the lit point to the point of the light
  /// Cosine at the lit point / (density of to_light in solid angle * area of the light); times the light's
  /// emission_over_pdf and reflectance / pi this is what the surface reflects. Not positive where the light
  /// or the surface faces away.
  poly<double> weight;
};

/// A density over the unit square that is linear in u and in v, by its values at the corners up to a factor.
struct Bilinear {
  poly<double> at_00;
  poly<double> at_10;  ///< u = 1, v = 0
  poly<double> at_01;
  poly<double> at_11;
};

inline poly<double> lerp(const poly<double>& from, const poly<double>& to, const poly<double>& share) {
  return from + (to - from) * share;
}

/// A number in [0, 1] with density in proportion to lerp(at_0, at_1, x), both positive: the integral's
/// quadratic solved for x, without cancellation.
inline poly<double> sample_linear(const poly<double>& u, const poly<double>& at_0, const poly<double>& at_1) {
  const poly<double> root = cn::sqrt(lerp(at_0 * at_0, at_1 * at_1, u));
  return cn::min(u * (at_0 + at_1) / (at_0 + root), poly<double>(1.0));
}

struct SquareSample {
  poly<double> u;
  poly<double> v;
  poly<double> pdf;
};

/// Warps uniform numbers to the density (Hart, Pharr, Mueller, Lopes, McGuire, Shirley, "Practical Product
/// Sampling by Fitting and Composing Warps", CGF 39(4), 2020): v by its marginal, then u.
inline SquareSample sample_bilinear(const Bilinear& f, const poly<double>& u, const poly<double>& v) {
  const poly<double> at_v0 = f.at_00 + f.at_10;
  const poly<double> at_v1 = f.at_01 + f.at_11;
  const poly<double> y = sample_linear(v, at_v0, at_v1);
  const poly<double> at_u0 = lerp(f.at_00, f.at_01, y);
  const poly<double> at_u1 = lerp(f.at_10, f.at_11, y);
  const poly<double> x = sample_linear(u, at_u0, at_u1);
  return {x, y, lerp(at_u0, at_u1, x) * 4.0 / (at_v0 + at_v1)};
}

/// A cosine as a corner value: positive, so that no direction above the horizon has density 0.
inline poly<double> corner_value(const poly<double>& cosine) {
  constexpr double kLeast = 0.01;
  return cn::max(cosine, poly<double>(kLeast));
}

/// Uniform in area; both cosines are scaled by the distance.
inline LightSample weigh_by_area(const Direction3& to_light, const Direction3& light_normal,
                                 const Direction3& normal) {
  const poly<double> distance_squared = dot(to_light, to_light);
  const poly<double> cosine_here = dot(to_light, normal);
  const poly<double> cosine_there = -dot(to_light, light_normal);
  const poly<double> geometry = cosine_here * cosine_there / (distance_squared * distance_squared);
  const mask faces = (cosine_here > 0.0) & (cosine_there > 0.0);
  return {to_light, cn::select(faces, geometry, poly<double>(0.0))};
}

/// A triangle, uniform in area.
inline LightSample sample_light_area(const LightSurface& light, const Point3& position,
                                     const Direction3& normal, const poly<double>& u, const poly<double>& v) {
  const Point3 on_light = sample_triangle(light.vertex, light.edge1, light.edge2, u, v);
  return weigh_by_area(on_light - position, light.normal, normal);
}

/// Below this solid angle its rounding would show, and a point uniform in area is as good: both densities
/// differ by the light's extent over its distance only, or the light is seen edge on.
inline constexpr double kLeastSolidAngle = 1e-7;

/// A rectangle, uniform in solid angle (Urena, Fajardo, King, "An Area-Preserving Parametrization for
/// Spherical Rectangles", CGF 32(4), 2013) under a warp to the cosine.
///
/// In coordinates along the edges the corners are (x0|x1, y0|y1, -z) and r their distances. The angles of the
/// complex numbers z r + i x y are arcsines of what the paper takes arccosines of, and products of such
/// numbers add angles: one arctangent instead of four arccosines, no rounding to outside their range.
inline LightSample sample_light_rectangle(const LightSurface& light, const Point3& position,
                                          const Direction3& normal, const poly<double>& u,
                                          const poly<double>& v) {
  const Direction3 to_vertex = light.vertex - position;
  const poly<double> z = -dot(to_vertex, light.normal);
  const poly<double> length1 = cn::sqrt(dot(light.edge1, light.edge1));
  const poly<double> length2 = cn::sqrt(dot(light.edge2, light.edge2));
  const poly<double> x0 = dot(to_vertex, light.edge1) / length1;
  const poly<double> y0 = dot(to_vertex, light.edge2) / length2;
  const poly<double> x1 = x0 + length1;
  const poly<double> y1 = y0 + length2;
  const poly<double> zz = z * z;
  const poly<double> y0z_squared = y0 * y0 + zz;
  const poly<double> y1z_squared = y1 * y1 + zz;
  const poly<double> r00 = cn::sqrt(x0 * x0 + y0z_squared);
  const poly<double> r10 = cn::sqrt(x1 * x1 + y0z_squared);
  const poly<double> r01 = cn::sqrt(x0 * x0 + y1z_squared);
  const poly<double> r11 = cn::sqrt(x1 * x1 + y1z_squared);

  // Angle between the corners at x0, and at x1; both in (0, pi).
  const poly<double> left_real = zz * r01 * r00 + x0 * x0 * y1 * y0;
  const poly<double> left_imaginary = z * x0 * (y1 * r00 - y0 * r01);
  const poly<double> right_real = zz * r11 * r10 + x1 * x1 * y1 * y0;
  const poly<double> right_imaginary = z * x1 * (y1 * r10 - y0 * r11);
  const poly<double> turn = cn::atan2(right_imaginary * left_real - right_real * left_imaginary,
                                      right_real * left_real + right_imaginary * left_imaginary);
  const poly<double> solid_angle = cn::select(turn < 0.0, turn + 2.0 * kPi, turn);

  const poly<double> cosine_00 = dot(to_vertex, normal);
  const poly<double> along1 = dot(light.edge1, normal);
  const poly<double> along2 = dot(light.edge2, normal);
  const SquareSample warped = sample_bilinear(
      {corner_value(cosine_00 / r00), corner_value((cosine_00 + along1) / r10),
       corner_value((cosine_00 + along2) / r01), corner_value((cosine_00 + along1 + along2) / r11)},
      u, v);

  // The column x that has the share u of the solid angle to its left.
  const poly<double> y0z = cn::sqrt(y0z_squared);
  const poly<double> y1z = cn::sqrt(y1z_squared);
  const poly<double> left_scale = 1.0 / ((x0 * x0 + zz) * y0z * y1z);
  const cn::SineCosine part = cn::sincos(warped.u * solid_angle);
  const poly<double> cosine = (left_real * part.cosine - left_imaginary * part.sine) * left_scale;
  const poly<double> sine = (left_imaginary * part.cosine + left_real * part.sine) * left_scale;
  const poly<double> c0 = y0 / y0z;
  const poly<double> c1 = y1 / y1z;
  const poly<double> lean = c1 - c0 * cosine;
  const poly<double> upright_squared = lean * lean + (c0 * c0 - 1.0) * sine * sine;
  constexpr double kTiny = 1e-30;
  const poly<double> x_on =
      cn::flip_sign(z * sine, lean) / cn::sqrt(cn::max(upright_squared, poly<double>(kTiny)));
  const poly<double> x = cn::min(cn::max(x_on, x0), x1);

  // Within the column the sine of the elevation is uniform.
  const poly<double> column_squared = x * x + zz;
  const poly<double> h0 = y0 / cn::sqrt(column_squared + y0 * y0);
  const poly<double> h1 = y1 / cn::sqrt(column_squared + y1 * y1);
  const poly<double> h = lerp(h0, h1, warped.v);
  const poly<double> y_on = h * cn::sqrt(column_squared / cn::max(1.0 - h * h, poly<double>(kTiny)));
  const poly<double> y = cn::min(cn::max(y_on, y0), y1);

  const Direction3 to_light =
      to_vertex + light.edge1 * ((x - x0) / length1) + light.edge2 * ((y - y0) / length2);
  const poly<double> cosine_here = dot(to_light, normal) / cn::sqrt(dot(to_light, to_light));
  LightSample sample{to_light, cosine_here * solid_angle / (warped.pdf * length1 * length2)};
  cn::poly_if_any(!((z > 0.0) & (solid_angle > kLeastSolidAngle)), [&] {
    const LightSample by_area =
        weigh_by_area(to_vertex + light.edge1 * u + light.edge2 * v, light.normal, normal);
    sample.to_light = by_area.to_light;
    sample.weight = by_area.weight;
  });
  return sample;
}

inline LightSample sample_light_solid_angle(const LightSurface& light, const poly<std::int32_t>& shape,
                                            const Point3& position, const Direction3& normal,
                                            const poly<double>& u, const poly<double>& v) {
  (void)shape;
  return sample_light_rectangle(light, position, normal, u, v);
}

}  // namespace path_tracer
