#pragma once

#include "firmware/path_tracer/materials/material.hpp"

/// Fresnel reflectance, and the directions of reflected and refracted light.
namespace path_tracer {

/// (1 - cosine)^5, the angular part of Schlick's approximation (Schlick, "An Inexpensive BRDF Model for
/// Physically-based Rendering", CGF 13(3), 1994).
inline poly<double> schlick_weight(const poly<double>& cosine) {
  const poly<double> c = 1.0 - cosine;
  const poly<double> c2 = c * c;
  return c2 * c2 * c;
}

/// What a ray meets at the boundary of two dielectrics.
struct DielectricSurface {
  poly<double> eta;
  poly<double> inverse_eta;
};

/// Cosine between the refracted ray and the normal; 0 at total reflection.
inline poly<double> refracted_cosine(const DielectricSurface& surface, const poly<double>& cosine) {
  // (eta - 1)(eta + 1) + cos^2 is eta^2 - sin^2 without its cancellation near eta = 1.
  const poly<double> square = (surface.eta - 1.0) * (surface.eta + 1.0) + cosine * cosine;
  return cn::sqrt(cn::max(square, poly<double>(0.0))) * surface.inverse_eta;
}

/// Reflectance for unpolarised light; 1 at total reflection. Both polarisations share one quotient.
/// @param cosine positive
inline poly<double> dielectric_fresnel(const DielectricSurface& surface, const poly<double>& cosine,
                                       const poly<double>& refracted) {
  const poly<double> far = surface.eta * cosine;
  const poly<double> near = surface.eta * refracted;
  const poly<double> parallel = (far - refracted) * (cosine + near);
  const poly<double> perpendicular = (cosine - near) * (far + refracted);
  const poly<double> scale = (far + refracted) * (cosine + near);
  return 0.5 * (parallel * parallel + perpendicular * perpendicular) / (scale * scale);
}

/// @param cosine dot(direction, axis)
inline Direction3 reflect(const Direction3& direction, const Direction3& axis, const poly<double>& cosine) {
  return axis * (2.0 * cosine) - direction;
}

/// Mirrors at the plane of the normal.
inline Direction3 mirror_at_plane(const Direction3& direction, const Direction3& normal,
                                  const poly<double>& cosine) {
  return direction - normal * (2.0 * cosine);
}

/// Refracts a direction that points away from the surface, on the side of `axis` (Snell's law).
inline Direction3 refract(const DielectricSurface& surface, const Direction3& direction,
                          const Direction3& axis, const poly<double>& cosine, const poly<double>& refracted) {
  return axis * (cosine * surface.inverse_eta - refracted) - direction * surface.inverse_eta;
}

}  // namespace path_tracer
