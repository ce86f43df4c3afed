#pragma once

#include "firmware/path_tracer/kernels/camera_rays.hpp"

/// The lens as the end of light paths: where a point of the scene appears on the film, and how densely camera
/// rays of that pixel reach it.
namespace path_tracer {

/// What the control unit computes of the camera once: coordinates on the film are products with `to_x` and
/// `to_y`.
struct Lens {
  vec3<double> position{};
  vec3<double> corner{};  ///< of the film, as seen from a pinhole
  vec3<double> to_x{};
  vec3<double> to_y{};
  vec3<double> area{};       ///< of a pixel, as a vector across the film
  vec3<double> direction{};  ///< of an orthographic camera's rays
  double corner_depth = 0;   ///< corner . area
  double pixel_area = 0;     ///< of an orthographic camera's pixel, across its rays
  bool is_orthographic = false;
  std::int32_t width = 0;
  std::int32_t height = 0;

  double pixels() const { return double(width) * double(height); }
};

inline Lens make_lens(const CameraRecord& camera) {
  Lens lens;
  lens.is_orthographic = camera.is_orthographic != 0;
  lens.position = camera.position;
  lens.corner = camera.direction;
  lens.direction = camera.direction;
  lens.width = camera.width;
  lens.height = camera.height;
  lens.area = cross(camera.right, camera.down);
  // Rays run across the film, or along the direction of an orthographic camera.
  const vec3<double> across = lens.is_orthographic ? camera.direction : lens.area;
  const double volume = dot(lens.area, across);
  lens.to_x = cross(camera.down, across) * (1.0 / volume);
  lens.to_y = cross(across, camera.right) * (1.0 / volume);
  lens.corner_depth = dot(lens.corner, lens.area);
  lens.pixel_area =
      lens.area.x * camera.direction.x + lens.area.y * camera.direction.y + lens.area.z * camera.direction.z;
  if (lens.pixel_area < 0) lens.pixel_area = -lens.pixel_area;
  return lens;
}

/// The density of a camera ray within its pixel: by solid angle, or by area across an orthographic camera's
/// rays.
/// @param direction of the ray, unit length
inline poly<double> camera_ray_pdf(const Lens& lens, const Direction3& direction) {
  if (lens.is_orthographic) return 1.0 / lens.pixel_area;
  // A pixel at distance r subtends its area * cosine / r^2; r is where the ray meets the film.
  const poly<double> along = dot(direction, lens.area);
  const poly<double> r = lens.corner_depth / along;
  return r * r / cn::abs(along);
}

/// A point of the scene on the film.
struct SeenPoint {
  Direction3 to_lens;  ///< from the point
  mask is_seen;        ///< by a pixel, if nothing is in between
  poly<std::int32_t> pixel;
};

/// How far a point is before the film, in units of the lens, and where its ray meets the film.
struct FilmPlace {
  poly<double> depth;
  Direction3 to_lens;
  vec3<poly<double>> on_film;
};

inline FilmPlace parallel_place(const Lens& lens, const vec3<poly<double>>& from_film) {
  const poly<double> depth = dot(from_film, lens.area) * (1.0 / dot(lens.area, lens.direction));
  const poly<double> back = -depth;
  return {depth, {back * lens.direction.x, back * lens.direction.y, back * lens.direction.z}, from_film};
}

inline FilmPlace pinhole_place(const Lens& lens, const vec3<poly<double>>& from_lens) {
  const poly<double> depth = dot(from_lens, lens.area) * (1.0 / lens.corner_depth);
  const poly<double> scale = 1.0 / cn::select(depth > 0.0, depth, poly<double>(1.0));
  return {depth, from_lens * -1.0, from_lens * scale - lens.corner};
}

inline SeenPoint see_point(const Lens& lens, const Point3& position) {
  const vec3<poly<double>> from_lens = position - lens.position;
  const FilmPlace place =
      lens.is_orthographic ? parallel_place(lens, from_lens) : pinhole_place(lens, from_lens);
  const poly<double> x = dot(place.on_film, lens.to_x);
  const poly<double> y = dot(place.on_film, lens.to_y);
  const mask is_seen =
      (place.depth > 0.0) & (x >= 0.0) & (x < double(lens.width)) & (y >= 0.0) & (y < double(lens.height));
  const poly<double> none = 0.0;
  const poly<std::int32_t> column = cn::convert<std::int32_t>(cn::select(is_seen, x, none));
  const poly<std::int32_t> row = cn::convert<std::int32_t>(cn::select(is_seen, y, none));
  return {place.to_lens, is_seen, row * lens.width + column};
}

}  // namespace path_tracer
