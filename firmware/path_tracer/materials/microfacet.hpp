#pragma once

#include "firmware/path_tracer/materials/material.hpp"

/// Isotropic GGX microfacets without a local frame where none is needed. Cosines are with the normal and
/// positive (kLeastCosine at least); alpha is 0 for a mirror, which has no density.
namespace path_tracer {

/// Factor by which GGX's masking stretches a direction: Smith's G1 = 2 cos / (cos + size). Its square is a
/// sum of positive terms, so nothing cancels (Heitz, "Understanding the Masking-Shadowing Function", JCGT
/// 3(2), 2014, equation 72).
inline poly<double> ggx_size(const poly<double>& alpha_squared, const poly<double>& cosine) {
  return cn::sqrt(alpha_squared + (1.0 - alpha_squared) * (cosine * cosine));
}

/// The direction halfway between two directions, not scaled to unit length.
struct HalfVector {
  poly<double> length_squared;
  poly<double> along_squared;   ///< of the part along the normal
  poly<double> across_squared;  ///< of the part across it: exact near the normal, unlike 1 - cos^2
  Direction3 direction;
  poly<double> along;
};

inline HalfVector half_vector(const Direction3& direction, const Direction3& normal) {
  const poly<double> along = dot(direction, normal);
  const Direction3 across = direction - normal * along;
  const poly<double> across_squared = dot(across, across);
  const poly<double> along_squared = along * along;
  return {across_squared + along_squared, along_squared, across_squared, direction, along};
}

/// GGX's distribution of normals D, per solid angle (Walter, Marschner, Li, Torrance, "Microfacet Models for
/// Refraction through Rough Surfaces", EGSR 2007, equation 33, times the square of the length).
inline poly<double> ggx_distribution(const poly<double>& alpha_squared, const HalfVector& half) {
  constexpr double kNotZero = 1e-150;
  const poly<double> slope = half.across_squared + alpha_squared * half.along_squared;
  const poly<double> ratio = half.length_squared / cn::max(slope, poly<double>(kNotZero));
  return alpha_squared * ratio * ratio * (1.0 / kPi);
}

/// G2 / (cosine of the viewer * cosine of the light), height-correlated (Heitz 2014, equation 99); its
/// cosines cancel.
inline poly<double> ggx_visibility(const poly<double>& cos_viewer, const poly<double>& size_viewer,
                                   const poly<double>& cos_light, const poly<double>& size_light) {
  return 2.0 / (cos_light * size_viewer + cos_viewer * size_light);
}

/// Two directions that complete a unit normal to a frame (Duff et al., "Building an Orthonormal Basis,
/// Revisited", JCGT 6(1), 2017).
struct Tangents {
  Direction3 first;
  Direction3 second;
};

inline Tangents tangents(const Direction3& normal) {
  const poly<double> sign = cn::flip_sign(poly<double>(1.0), normal.z);
  const poly<double> a = -1.0 / (sign + normal.z);
  const poly<double> b = normal.x * normal.y * a;
  return {{1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x},
          {b, sign + normal.y * normal.y * a, -normal.y}};
}

/// The viewer in the space where the microfacets are a hemisphere; unit length.
struct StretchedViewer {
  Direction3 direction;
  poly<double> height;  ///< cosine with the normal
};

inline StretchedViewer stretch_viewer(const Direction3& to_viewer, const Direction3& normal,
                                      const poly<double>& cosine, const poly<double>& alpha,
                                      const poly<double>& size) {
  const poly<double> inverse = 1.0 / size;
  const poly<double> height = cosine * inverse;
  return {to_viewer * (alpha * inverse) + normal * ((1.0 - alpha) * height),
          cn::min(height, poly<double>(1.0))};
}

/// A point of the unit sphere's cap above `-height`, around the z axis. Height 1 is the whole sphere.
inline Direction3 sample_cap(const poly<double>& height, const poly<double>& u, const poly<double>& v) {
  const poly<double> z = 1.0 - (1.0 + height) * u;
  const poly<double> radius = cn::sqrt(1.0 - z * z);
  const cn::SineCosine angle = cn::sincos(2.0 * kPi * v);
  return {radius * angle.cosine, radius * angle.sine, z};
}

}  // namespace path_tracer
