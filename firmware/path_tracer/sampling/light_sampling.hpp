#pragma once

#include "firmware/path_tracer/program/program_config.hpp"
#include "firmware/path_tracer/sampling/sampling.hpp"

/// Sampling a point on a light, as seen from a point that it may light.
namespace path_tracer {

/// The geometry of a LightRecord.
struct LightSurface {
  Point3 vertex;
  Direction3 edge1;
  Direction3 edge2;
  Direction3 normal;
};

struct LightSample {
  Direction3 to_light;  ///< from the lit point to the point of the light
  /// Cosine at the lit point / (density of to_light in solid angle * area of the light). Times the light's
  /// emission and inverse_pdf, and reflectance / pi, it is the reflected radiance. Not positive if the light
  /// or the surface faces away.
  poly<double> weight;
};

/// A density over the unit square, linear in u and in v, given by its values at the corners up to a factor.
struct Bilinear {
  poly<double> at_00;
  poly<double> at_10;  ///< u = 1, v = 0
  poly<double> at_01;
  poly<double> at_11;
};

inline poly<double> lerp(const poly<double>& from, const poly<double>& to, const poly<double>& share) {
  return from + (to - from) * share;
}

/// Samples a number in [0, 1] with density proportional to lerp(at_0, at_1, x), both positive: solves the
/// integral's quadratic for x without cancellation.
inline poly<double> sample_linear(const poly<double>& u, const poly<double>& at_0, const poly<double>& at_1) {
  const poly<double> root = cn::sqrt(lerp(at_0 * at_0, at_1 * at_1, u));
  return cn::min(u * (at_0 + at_1) / (at_0 + root), poly<double>(1.0));
}

/// A point of the unit square.
struct SquareSample {
  poly<double> u;
  poly<double> v;
  poly<double> inverse_pdf;
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
  return {x, y, (at_v0 + at_v1) * 0.25 / lerp(at_u0, at_u1, x)};
}

/// Turns a cosine into a corner value: positive, so that no direction above the horizon has density 0.
inline constexpr double kLeastCornerCosine = 0.01;
inline poly<double> corner_value(const poly<double>& cosine) {
  return cn::max(cosine, poly<double>(kLeastCornerCosine));
}
/// corner_value() of height / distance, times the distance.
inline poly<double> corner_height(const poly<double>& height, const poly<double>& distance) {
  return cn::max(height, distance * kLeastCornerCosine);
}

/// Weighs the point that to_light reaches, sampled uniformly in area. Both cosines are scaled by the
/// distance.
inline LightSample weigh_by_area(const Direction3& to_light, const Direction3& light_normal,
                                 const Direction3& normal) {
  const poly<double> distance_squared = dot(to_light, to_light);
  const poly<double> cosine_here = dot(to_light, normal);
  const poly<double> cosine_there = -dot(to_light, light_normal);
  const poly<double> geometry = cosine_here * cosine_there / (distance_squared * distance_squared);
  const mask faces = (cosine_here > 0.0) & (cosine_there > 0.0);
  return {to_light, cn::select(faces, geometry, poly<double>(0.0))};
}

/// Samples a triangle uniformly in area.
inline LightSample sample_light_area(const LightSurface& light, const Point3& position,
                                     const Direction3& normal, const poly<double>& u, const poly<double>& v) {
  const Point3 on_light = sample_triangle(light.vertex, light.edge1, light.edge2, u, v);
  return weigh_by_area(on_light - position, light.normal, normal);
}

/// Smallest solid angle of a rectangle to sample. Below it rounding would show, and a point uniform in area
/// is as good: the light is small for its distance, or seen edge on.
inline constexpr double kLeastSolidAngle = 1e-6;

/// Keeps quotients and roots finite whose argument rounding may take to zero or below.
inline poly<double> at_least_tiny(const poly<double>& value) {
  return cn::max(value, poly<double>(1e-30));
}

/// Least share of the sum of squares that their difference keeps, for the same reason and at any scale.
inline constexpr double kLeastShare = 1e-30;
inline constexpr double kNotZero = 1e-280;

/// A direction in the solid angle of a light.
struct SolidAngleSample {
  Direction3 to_light;
  poly<double> solid_angle;
  poly<double> inverse_pdf;  ///< over the unit square that is mapped onto the solid angle
};

inline LightSample weigh_by_solid_angle(const SolidAngleSample& sample, const Direction3& normal,
                                        const poly<double>& area) {
  const poly<double> distance = cn::sqrt(dot(sample.to_light, sample.to_light));
  return {sample.to_light,
          dot(sample.to_light, normal) * sample.solid_angle * sample.inverse_pdf / (distance * area)};
}

/// A rectangle as seen from a point in front of it. In coordinates along its edges, its corners are (x0|x1,
/// y0|y1, -z); r are their distances.
///
/// The angles of the complex numbers z r + i x y are the arcsines that replace Urena's arccosines, and
/// products of such numbers add angles. So one arctangent replaces four arccosines, whose arguments rounding
/// may take out of [-1, 1].
struct RectangleView {
  poly<double> inverse_length1, inverse_length2;
  poly<double> area;
  poly<double> x0, x1, y0, y1, z;
  poly<double> r00, r10, r01, r11;
  poly<double> left_real, left_imaginary;  ///< angle of the arc between the corners at x0, in (-pi, pi)
  poly<double> solid_angle;
};

inline RectangleView view_rectangle(const LightSurface& light, const Direction3& to_vertex) {
  RectangleView view;
  const poly<double> length1 = cn::sqrt(dot(light.edge1, light.edge1));
  const poly<double> length2 = cn::sqrt(dot(light.edge2, light.edge2));
  view.area.assign_all_lanes(length1 * length2);
  const poly<double> inverse_area = 1.0 / view.area;
  view.inverse_length1.assign_all_lanes(length2 * inverse_area);
  view.inverse_length2.assign_all_lanes(length1 * inverse_area);
  view.x0.assign_all_lanes(dot(to_vertex, light.edge1) * view.inverse_length1);
  view.y0.assign_all_lanes(dot(to_vertex, light.edge2) * view.inverse_length2);
  view.x1.assign_all_lanes(view.x0 + length1);
  view.y1.assign_all_lanes(view.y0 + length2);
  view.z.assign_all_lanes(-dot(to_vertex, light.normal));
  const poly<double> zz = view.z * view.z;
  const poly<double> x0_squared = view.x0 * view.x0;
  const poly<double> x1_squared = view.x1 * view.x1;
  const poly<double> y0z_squared = view.y0 * view.y0 + zz;
  const poly<double> y1z_squared = view.y1 * view.y1 + zz;
  view.r00.assign_all_lanes(cn::sqrt(x0_squared + y0z_squared));
  view.r10.assign_all_lanes(cn::sqrt(x1_squared + y0z_squared));
  view.r01.assign_all_lanes(cn::sqrt(x0_squared + y1z_squared));
  view.r11.assign_all_lanes(cn::sqrt(x1_squared + y1z_squared));
  const poly<double> yy = view.y1 * view.y0;
  view.left_real.assign_all_lanes(zz * view.r01 * view.r00 + x0_squared * yy);
  view.left_imaginary.assign_all_lanes(view.z * view.x0 * (view.y1 * view.r00 - view.y0 * view.r01));
  const poly<double> right_real = zz * view.r11 * view.r10 + x1_squared * yy;
  const poly<double> right_imaginary = view.z * view.x1 * (view.y1 * view.r10 - view.y0 * view.r11);
  const poly<double> turn = cn::atan2(right_imaginary * view.left_real - right_real * view.left_imaginary,
                                      right_real * view.left_real + right_imaginary * view.left_imaginary);
  view.solid_angle.assign_all_lanes(cn::select(turn < 0.0, turn + 2.0 * kPi, turn));  // at most 2 pi
  return view;
}

/// Returns the x with the share u of the solid angle to its left. Urena's quotients have a common
/// denominator, which cancels.
inline poly<double> rectangle_column(const RectangleView& view, const poly<double>& u) {
  const poly<double> zz = view.z * view.z;
  const poly<double> y0z_squared = view.y0 * view.y0 + zz;
  const cn::SineCosine part = cn::sincos(u * view.solid_angle);
  const poly<double> real = view.left_real * part.cosine - view.left_imaginary * part.sine;
  const poly<double> imaginary = view.left_imaginary * part.cosine + view.left_real * part.sine;
  const poly<double> lean = view.y1 * (view.x0 * view.x0 + zz) * y0z_squared - view.y0 * real;
  const poly<double> across = view.z * imaginary;
  const poly<double> size_squared = lean * lean - across * across;
  const poly<double> least = (lean * lean + across * across) * kLeastShare + kNotZero;
  const poly<double> x = cn::flip_sign(across, lean) * cn::sqrt(y0z_squared / cn::max(size_squared, least));
  return cn::min(cn::max(x, view.x0), view.x1);
}

/// Samples the height within a column, where the sine of the elevation is uniform.
inline poly<double> rectangle_row(const RectangleView& view, const poly<double>& x, const poly<double>& v) {
  const poly<double> column_squared = x * x + view.z * view.z;
  const poly<double> low_size = cn::sqrt(column_squared + view.y0 * view.y0);
  const poly<double> high_size = cn::sqrt(column_squared + view.y1 * view.y1);
  // The sine and the 1 it is compared with, both scaled by the same size.
  const poly<double> one = low_size * high_size;
  const poly<double> sine = lerp(view.y0 * high_size, view.y1 * low_size, v);
  const poly<double> cosine_squared = cn::max((one - sine) * (one + sine), one * one * kLeastShare);
  const poly<double> y = sine * cn::sqrt(column_squared / cosine_squared);
  return cn::min(cn::max(y, view.y0), view.y1);
}

/// Samples uniformly in solid angle (Urena, Fajardo, King, "An Area-Preserving Parametrization for Spherical
/// Rectangles", CGF 32(4), 2013), warped to the cosine.
inline SolidAngleSample sample_rectangle(const LightSurface& light, const RectangleView& view,
                                         const Direction3& to_vertex, const Direction3& normal,
                                         const poly<double>& u, const poly<double>& v) {
  const poly<double> height_00 = dot(to_vertex, normal);
  const poly<double> along1 = dot(light.edge1, normal);
  const poly<double> along2 = dot(light.edge2, normal);
  // Each cosine is height / r; the warp needs only their proportions.
  const poly<double> r00_r11 = view.r00 * view.r11;
  const poly<double> r10_r01 = view.r10 * view.r01;
  const SquareSample warped =
      sample_bilinear({corner_height(height_00, view.r00) * view.r11 * r10_r01,
                       corner_height(height_00 + along1, view.r10) * view.r01 * r00_r11,
                       corner_height(height_00 + along2, view.r01) * view.r10 * r00_r11,
                       corner_height(height_00 + along1 + along2, view.r11) * view.r00 * r10_r01},
                      u, v);
  const poly<double> x = rectangle_column(view, warped.u);
  const poly<double> y = rectangle_row(view, x, warped.v);
  return {to_vertex + light.edge1 * ((x - view.x0) * view.inverse_length1) +
              light.edge2 * ((y - view.y0) * view.inverse_length2),
          view.solid_angle, warped.inverse_pdf};
}

/// A triangle as seen from a point in front of it: unit vectors to its corners, counterclockwise as seen from
/// its front.
///
/// Needles and distant lights have corners whose directions differ in their last digits only, and seen from
/// close by, a long side spans nearly half a turn. So no cosine stands for an angle here: chords do, which
/// are computed from the light's edges, where nothing cancels. What is left is a relative error of the solid
/// angle of about e (length / z)^2, with e = 2^-53, for a light seen from a distance z close to its long
/// side.
struct TriangleView {
  Direction3 a, b, c;
  poly<double> inverse_length_a, inverse_length_b, inverse_length_c;  ///< of the vectors to the corners
  Direction3 chord_ac;                                                ///< c - a
  poly<double> volume;           ///< a . (b x c), positive in front of it
  poly<double> one_plus_cosine;  ///< 1 + a . b
  poly<double> lean;             ///< (a + b) . (c - a)
  poly<double> solid_angle;
};

inline poly<double> inverse_length(const Direction3& v) {
  return 1.0 / cn::sqrt(cn::max(dot(v, v), poly<double>(kNotZero)));
}

/// Solid angle after Van Oosterom and Strackee, IEEE Trans. Biomed. Eng. 30(2), 1983.
/// @param z distance from the light's plane
inline TriangleView view_triangle(const LightSurface& light, const Direction3& to_vertex,
                                  const poly<double>& z) {
  TriangleView view;
  const Direction3 to_b = to_vertex + light.edge2;
  const Direction3 to_c = to_vertex + light.edge1;
  view.inverse_length_a.assign_all_lanes(inverse_length(to_vertex));
  view.inverse_length_b.assign_all_lanes(inverse_length(to_b));
  view.inverse_length_c.assign_all_lanes(inverse_length(to_c));
  view.a = to_vertex * view.inverse_length_a;
  view.b = to_b * view.inverse_length_b;
  view.c = to_c * view.inverse_length_c;
  // |c'| / |a'| - 1 of the vectors a', c' to the corners: (c'^2 - a'^2) / (a'^2 + |a'| |c'|).
  const poly<double> length_a = dot(to_vertex, view.a);
  const poly<double> length_c = dot(to_c, view.c);
  const poly<double> longer = dot(light.edge1, to_vertex + to_c) / (length_a * (length_a + length_c));
  view.chord_ac = (light.edge1 - to_vertex * longer) * view.inverse_length_c;
  const poly<double> twice_area = dot(cross(light.edge1, light.edge2), light.normal);
  view.volume.assign_all_lanes((z * view.inverse_length_a) *
                               (twice_area * (view.inverse_length_b * view.inverse_length_c)));
  const Direction3 sum = view.a + view.b;
  view.one_plus_cosine.assign_all_lanes(0.5 * dot(sum, sum));
  view.lean.assign_all_lanes(dot(sum, view.chord_ac));
  view.solid_angle.assign_all_lanes(2.0 * cn::atan2(view.volume, 2.0 * view.one_plus_cosine + view.lean));
  return view;
}

/// Returns the share w of the chord from a to c at which the triangle (a, b, a + w (c - a)) has the share u
/// of the solid angle. It solves Van Oosterom's and Strackee's equation for w: with t = tan(u S / 2), k = 1 +
/// a.b, e = (a + b).(c - a) and d = |c - a|, the square root |a + w (c - a)| in it leaves a linear equation,
/// w ((V - t e)^2 - (t k d)^2) = t k (2 (V - t e) - t k d^2). Here both sides are times cos^2(u S / 2).
inline poly<double> share_of_chord(const TriangleView& view, const poly<double>& u) {
  const cn::SineCosine part = cn::sincos(0.5 * u * view.solid_angle);
  const poly<double> chord_squared = dot(view.chord_ac, view.chord_ac);
  const poly<double> rest = view.volume * part.cosine - part.sine * view.lean;
  const poly<double> sine_k = part.sine * view.one_plus_cosine;
  const poly<double> denominator = rest * rest - sine_k * sine_k * chord_squared;
  const poly<double> numerator = sine_k * (2.0 * rest - sine_k * chord_squared);
  const poly<double> w = numerator / cn::max(denominator, poly<double>(kNotZero));
  return cn::min(cn::max(w, poly<double>(0.0)), poly<double>(1.0));
}

/// Returns the share of the chord between two unit vectors at which the arc reaches the cosine 1 - v (1 -
/// their cosine). Sines of half angles are half chords: the arc's is s, that of its part s sqrt(v).
/// @param half_chord_squared s^2
/// @param rest 1 - s^2
inline poly<double> share_of_arc(const poly<double>& half_chord_squared, const poly<double>& rest,
                                 const poly<double>& v) {
  const poly<double> root = cn::sqrt(v);
  const poly<double> part = v * half_chord_squared;
  const poly<double> sine_there = root * cn::sqrt(cn::max(1.0 - part, poly<double>(0.0)));
  const poly<double> sine_left =
      cn::sqrt(rest) * (1.0 - 2.0 * part) - (1.0 - 2.0 * half_chord_squared) * sine_there;
  const poly<double> left = cn::max(sine_left, poly<double>(0.0));
  return sine_there / at_least_tiny(left + sine_there);
}

/// Samples uniformly in solid angle (Arvo, "Stratified Sampling of Spherical Triangles", SIGGRAPH 1995),
/// warped to the cosine: c moves along its side until the triangle has the share u of its solid angle, then v
/// chooses between b and the moved point. The result is a mean of the corners with positive weights, so
/// rounding takes it out of the light by no more than its own.
inline SolidAngleSample sample_spherical_triangle(const LightSurface& light, const TriangleView& view,
                                                  const Direction3& to_vertex, const Direction3& normal,
                                                  const poly<double>& u, const poly<double>& v) {
  const poly<double> corner_a = corner_value(dot(view.a, normal));
  const poly<double> corner_b = corner_value(dot(view.b, normal));
  const poly<double> corner_c = corner_value(dot(view.c, normal));
  const SquareSample warped = sample_bilinear({corner_b, corner_b, corner_a, corner_c}, u, v);

  const poly<double> w = share_of_chord(view, warped.u);
  const Direction3 moved = view.a + view.chord_ac * w;
  const poly<double> inverse_moved = inverse_length(moved);
  const Direction3 moved_unit = moved * inverse_moved;
  const Direction3 chord = moved_unit - view.b;
  const Direction3 sum = moved_unit + view.b;
  const poly<double> towards = share_of_arc(0.25 * dot(chord, chord), 0.25 * dot(sum, sum), warped.v);

  const poly<double> scale = towards * inverse_moved;
  const poly<double> at_a = (1.0 - w) * view.inverse_length_a * scale;
  const poly<double> at_b = (1.0 - towards) * view.inverse_length_b;
  const poly<double> at_c = w * view.inverse_length_c * scale;
  const poly<double> inverse_sum = 1.0 / (at_a + at_b + at_c);
  return {to_vertex + light.edge2 * (at_b * inverse_sum) + light.edge1 * (at_c * inverse_sum),
          view.solid_angle, warped.inverse_pdf};
}

/// Samples uniformly in solid angle, warped to the cosine; a rectangle of too small a solid angle uniformly
/// in area.
inline LightSample sample_light_solid_angle(const LightSurface& light, const poly<std::int32_t>& shape,
                                            const Point3& position, const Direction3& normal,
                                            const poly<double>& u, const poly<double>& v) {
  const Direction3 to_vertex = light.vertex - position;
  const poly<double> z = -dot(to_vertex, light.normal);
  const mask is_rectangle = shape == static_cast<std::int32_t>(LightShape::rectangle);
  const Direction3 in_rectangle = to_vertex + light.edge1 * u + light.edge2 * v;
  const Direction3 in_triangle = sample_triangle(to_vertex, light.edge1, light.edge2, u, v);
  LightSample sample =
      weigh_by_area(cn::select(is_rectangle, in_rectangle, in_triangle), light.normal, normal);
  const auto take = [&](const LightSample& other) {
    sample.to_light = other.to_light;
    sample.weight = other.weight;
  };
  cn::poly_if_any(is_rectangle, [&] {
    const RectangleView view = view_rectangle(light, to_vertex);
    cn::poly_if((z > 0.0) & (view.solid_angle > kLeastSolidAngle), [&] {
      take(weigh_by_solid_angle(sample_rectangle(light, view, to_vertex, normal, u, v), normal, view.area));
    });
  });
  cn::poly_if_any(!is_rectangle, [&] {
    const TriangleView view = view_triangle(light, to_vertex, z);
    cn::poly_if((z > 0.0) & (view.solid_angle > kNotZero), [&] {
      take(weigh_by_solid_angle(sample_spherical_triangle(light, view, to_vertex, normal, u, v), normal,
                                0.5 * dot(cross(light.edge1, light.edge2), light.normal)));
    });
  });
  return sample;
}

/// A point of the light and what it contributes.
inline LightSample sample_light(LightSampling sampling, const LightSurface& light,
                                const poly<std::int32_t>& shape, const Point3& position,
                                const Direction3& normal, const poly<double>& u, const poly<double>& v) {
  return sampling == LightSampling::area ? sample_light_area(light, position, normal, u, v)
                                         : sample_light_solid_angle(light, shape, position, normal, u, v);
}

}  // namespace path_tracer
