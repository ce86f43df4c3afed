#include "testbench/scene/normalise.hpp"

#include <algorithm>
#include <cmath>

namespace testbench {

double largest_coordinate(const Scene& scene) {
  double largest = 0.0;
  for (const Triangle& triangle : scene.triangles)
    for (const glm::dvec3& vertex : triangle.vertex)
      largest = std::max({largest, std::abs(vertex.x), std::abs(vertex.y), std::abs(vertex.z)});
  return largest;
}

namespace {

/// What is to be subtracted from all places: 0 along axes along which the scene is not far away.
glm::dvec3 far_middle(const std::vector<Triangle>& triangles) {
  if (triangles.empty()) return glm::dvec3(0.0);
  glm::dvec3 lower = triangles[0].vertex[0];
  glm::dvec3 upper = lower;
  for (const Triangle& triangle : triangles)
    for (const glm::dvec3& vertex : triangle.vertex) {
      lower = glm::min(lower, vertex);
      upper = glm::max(upper, vertex);
    }
  const glm::dvec3 sides = upper - lower;
  const double longest = std::max({sides.x, sides.y, sides.z});
  glm::dvec3 middle = lower + sides / 2.0;
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
