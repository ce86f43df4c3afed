#include "testbench/scene/film_ray.hpp"

#include <cmath>

namespace testbench {

FilmPlane film_plane(const Camera& camera, const FilmSize& film) {
  const glm::dvec3 right = glm::cross(camera.direction, camera.up);
  const double height =
      camera.orthographic_height.value_or(2.0 * std::tan(0.5 * camera.vertical_field_of_view_radians));
  const double pixel_size = height / film.height;
  const glm::dvec3 centre = camera.orthographic_height ? camera.position : camera.direction;
  return {centre - right * (0.5 * film.width * pixel_size) + camera.up * (0.5 * film.height * pixel_size),
          right * pixel_size, -camera.up * pixel_size};
}

FilmRay film_ray(const Scene& scene, double x, double y) {
  const FilmPlane plane = film_plane(scene.camera, scene.film);
  const glm::dvec3 point = plane.corner + x * plane.right + y * plane.down;
  if (scene.camera.orthographic_height) return {point, scene.camera.direction};
  return {scene.camera.position, point};
}

}  // namespace testbench
