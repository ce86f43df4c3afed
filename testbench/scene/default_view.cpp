#include "testbench/scene/default_view.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace testbench {
namespace {

/// A sphere around all triangles.
struct Bounds {
  glm::dvec3 centre{0.0};
  double radius = 0.0;
};

Bounds bounds_of(const Scene& scene) {
  glm::dvec3 low(scene.triangles.front().vertex[0]);
  glm::dvec3 high = low;
  for (const Triangle& triangle : scene.triangles) {
    for (const glm::dvec3& vertex : triangle.vertex) {
      low = glm::min(low, vertex);
      high = glm::max(high, vertex);
    }
  }
  return {0.5 * (low + high), 0.5 * glm::length(high - low)};
}

}  // namespace

Camera framing_camera(const Scene& scene) {
  const Bounds bounds = bounds_of(scene);
  Camera camera;
  camera.vertical_field_of_view_radians = glm::radians(40.0);
  camera.direction = glm::normalize(glm::dvec3(-0.4, -0.35, -1.0));
  const glm::dvec3 side = glm::normalize(glm::cross(camera.direction, glm::dvec3(0.0, 1.0, 0.0)));
  camera.up = glm::cross(side, camera.direction);
  constexpr double kMargin = 1.02;
  const double distance = kMargin * bounds.radius / std::sin(0.5 * camera.vertical_field_of_view_radians);
  camera.position = bounds.centre - distance * camera.direction;
  return camera;
}

bool has_light(const Scene& scene) {
  if (scene.environment.is_lit() || !scene.lights.empty()) return true;
  return std::any_of(scene.triangles.begin(), scene.triangles.end(), [&scene](const Triangle& triangle) {
    return scene.materials[static_cast<std::size_t>(triangle.material)].emission != glm::dvec3(0.0);
  });
}

void add_default_light(Scene& scene) {
  const Bounds bounds = bounds_of(scene);
  const glm::dvec3 to_camera = scene.camera.position - bounds.centre;
  const double to_camera_length = glm::length(to_camera);
  const glm::dvec3 towards = to_camera_length > 0.0 ? to_camera / to_camera_length : -scene.camera.direction;
  const glm::dvec3 to_light = glm::normalize(towards + 0.5 * scene.camera.up);
  const double distance = std::max(3.5 * bounds.radius, 1.2 * to_camera_length);
  constexpr double kSidePerDistance = 0.25;

  const glm::dvec3 normal = -to_light;
  const double half_side = 0.5 * kSidePerDistance * distance;
  const glm::dvec3 u = half_side * glm::normalize(glm::cross(scene.camera.up, normal));
  const glm::dvec3 v = half_side * glm::normalize(glm::cross(normal, u));
  const glm::dvec3 centre = bounds.centre + distance * to_light;
  const auto material = static_cast<std::int32_t>(scene.materials.size());
  // Irradiance at the centre: radiance times area / distance^2. White reflects 1 / pi of it (Lambert).
  const double radiance = glm::pi<double>() / (kSidePerDistance * kSidePerDistance);
  scene.materials.push_back({"default light", glm::dvec3(0.0), glm::dvec3(radiance)});
  scene.triangles.push_back({{centre - u - v, centre + u - v, centre + u + v}, material});
  scene.triangles.push_back({{centre - u - v, centre + u + v, centre - u + v}, material});
}

}  // namespace testbench
