#pragma once

#include "testbench/scene/scene.hpp"

namespace testbench {

/// A camera's film in the scene. The point at (x, y), in pixels from the upper left corner, is corner + x *
/// right + y * down: for a pinhole camera the direction of its ray, which starts at the camera's position;
/// for an orthographic one the point where its ray starts, along the camera's direction.
struct FilmPlane {
  glm::dvec3 corner;
  glm::dvec3 right;
  glm::dvec3 down;
};
FilmPlane film_plane(const Camera& camera, const FilmSize& film);

/// The ray through a point of the film.
struct FilmRay {
  glm::dvec3 origin;
  glm::dvec3 direction;  ///< of any length
};
/// @param x, y in pixels from the upper left corner
FilmRay film_ray(const Scene& scene, double x, double y);

}  // namespace testbench
