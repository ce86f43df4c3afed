#include "testbench/scene/normalise.hpp"

#include <algorithm>
#include <cmath>

#include "testbench/scene/triangle_bounds.hpp"

namespace testbench {

double largest_coordinate(const Scene& scene) {
  const TriangleBounds bounds = bounds_of(scene.triangles);
  const glm::dvec3 largest = glm::max(glm::abs(bounds.lower), glm::abs(bounds.upper));
  return std::max({largest.x, largest.y, largest.z});
}

namespace {

/// What is to be subtracted from all places: 0 along axes along which the scene is not far away.
glm::dvec3 far_middle(const std::vector<Triangle>& triangles) {
  const TriangleBounds bounds = bounds_of(triangles);
  const glm::dvec3 sides = bounds.sides();
  const double longest = std::max({sides.x, sides.y, sides.z});
  glm::dvec3 middle = bounds.middle();
  for (int axis = 0; axis < 3; ++axis)
    if (!(std::abs(middle[axis]) > 16.0 * longest)) middle[axis] = 0.0;
  return middle;
}

void move_to_origin(Scene& scene) {
  const glm::dvec3 middle = far_middle(scene.triangles);
  if (middle == glm::dvec3(0.0)) return;
  scene.rounded_at = std::max(scene.rounded_at, largest_coordinate(scene));
  scene.camera.position -= middle;
  for (Triangle& triangle : scene.triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex -= middle;
  for (Light& light : scene.lights) light.position -= middle;
}

}  // namespace

Scene normalised(const Scene& scene) {
  Scene result = scene;
  move_to_origin(result);
  const double largest = largest_coordinate(result);
  if (!(largest > 0.0)) return result;
  // A power of two below 2^-1022 has no inverse; coordinates that small keep their unit's lowest bits anyway.
  const double scale = std::ldexp(1.0, -std::max(std::ilogb(largest), -1022));
  result.rounded_at *= scale;
  result.camera.position *= scale;
  if (result.camera.orthographic_height) *result.camera.orthographic_height *= scale;
  for (Triangle& triangle : result.triangles)
    for (glm::dvec3& vertex : triangle.vertex) vertex *= scale;
  for (Material& material : result.materials) material.attenuation_distance *= scale;
  for (Light& light : result.lights) {
    light.position *= scale;
    const bool is_near = light.kind == LightKind::point || light.kind == LightKind::spot;
    if (is_near) light.intensity *= scale * scale;  // irradiance is intensity by squared distance
  }
  return result;
}

}  // namespace testbench
