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

Scene normalised(const Scene& scene) {
  Scene result = scene;
  const double largest = largest_coordinate(scene);
  if (!(largest > 0.0)) return result;
  // A power of two below 2^-1022 has no inverse; coordinates that small keep their unit's lowest bits anyway.
  const double scale = std::ldexp(1.0, -std::max(std::ilogb(largest), -1022));
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
