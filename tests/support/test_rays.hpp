#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "firmware/path_tracer/records/records.hpp"
#include "testbench/bvh/bvh.hpp"
#include "testbench/mono_image/faces.hpp"

namespace test_support {

/// Random rays of the kinds that occur in renders, and of kinds that are sensitive to rounding: along edges,
/// through vertices, within planes, with components of zero. All start within the scene's box.
class TestRays {
 public:
  TestRays(const testbench::Scene& scene, unsigned seed)
      : triangles_(scene.triangles), faces_(testbench::number_faces(scene.triangles)), random_(seed) {
    box_.include(scene.camera.position);
    for (const testbench::Triangle& triangle : triangles_) box_.include(bounds_of(triangle));
  }

  static constexpr unsigned kKinds = 9;

  path_tracer::RayRecord ray(unsigned kind) {
    path_tracer::RayRecord ray;
    const std::size_t from = any_triangle();
    glm::dvec3 origin = anywhere();
    glm::dvec3 direction;
    switch (kind) {
      case 0:
        direction = anywhere() - origin;
        break;
      case 1:
        direction = on(any_triangle()) - origin;
        break;
      case 2:
        direction = vertex(any_triangle()) - origin;
        break;
      case 3:
        direction = on_edge(any_triangle()) - origin;
        break;
      case 4: {  // along an edge, from one of its points or vertices
        origin = one_in(2) ? vertex(from) : on_edge(from);
        direction = edge(from) * (one_in(2) ? 1.0 : -1.0);
        break;
      }
      case 5: {  // along an axis, through a vertex
        const int axis = int(random_() % 3);
        const bool up = one_in(2);
        origin = vertex(from);
        origin[axis] = up ? box_.lower[axis] : box_.upper[axis];
        direction = glm::dvec3(one_in(2) ? 0.0 : -0.0);
        direction[axis] = (box_.upper[axis] - box_.lower[axis]) * (up ? 1.0 : -1.0);
        break;
      }
      case 6:  // from a surface, as the segments of a path
        origin = on(from);
        direction = (one_in(2) ? anywhere() : vertex(any_triangle())) - origin;
        ray.left_face = faces_[from];
        break;
      case 7:  // within a triangle's plane, or nearly so
        origin = on(from);
        direction = edge(from) * number(-1, 1) + edge(from) * number(-1, 1);
        if (one_in(2)) direction += (anywhere() - origin) * 1e-14;
        break;
      default:  // from a vertex to a vertex
        origin = vertex(from);
        direction = vertex(any_triangle()) - origin;
        break;
    }
    if (one_in(3)) direction[int(random_() % 3)] = one_in(2) ? 0.0 : -0.0;
    if (direction == glm::dvec3(0.0)) direction = box_.upper - box_.lower;
    const double largest = std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (one_in(2)) direction /= largest;
    put(ray.origin, origin);
    put(ray.direction, direction);
    return ray;
  }

  /// A shadow ray towards a point on one of the light's triangles.
  path_tracer::RayRecord shadow_ray(const std::vector<std::size_t>& light) {
    path_tracer::RayRecord ray;
    const std::size_t from = any_triangle();
    const std::size_t to = light[random_() % light.size()];
    const bool leaves = one_in(2);
    const glm::dvec3 origin = leaves ? on(from) : anywhere();
    const glm::dvec3 target = one_in(4) ? vertex(to) : one_in(4) ? on_edge(to) : on(to);
    put(ray.origin, origin);
    put(ray.direction, target == origin ? glm::dvec3(1.0) : target - origin);
    if (leaves) ray.left_face = faces_[from];
    ray.light_face = faces_[to];
    return ray;
  }

  std::int32_t face(std::int32_t triangle) const { return faces_[std::size_t(triangle)]; }

 private:
  static void put(cn::vec3<double>& to, const glm::dvec3& v) { to = {v.x, v.y, v.z}; }
  bool one_in(unsigned count) { return random_() % count == 0; }
  double number(double least, double most) {
    return std::uniform_real_distribution<double>(least, most)(random_);
  }
  std::size_t any_triangle() { return random_() % triangles_.size(); }
  glm::dvec3 anywhere() {
    const glm::dvec3 part(number(0, 1), number(0, 1), number(0, 1));
    return glm::clamp(box_.lower * (1.0 - part) + box_.upper * part, box_.lower, box_.upper);
  }
  const glm::dvec3& vertex(std::size_t triangle) { return triangles_[triangle].vertex[random_() % 3]; }
  glm::dvec3 edge(std::size_t triangle) {
    const std::size_t k = random_() % 3;
    return triangles_[triangle].vertex[(k + 1) % 3] - triangles_[triangle].vertex[k];
  }
  glm::dvec3 on_edge(std::size_t triangle) {
    const std::size_t k = random_() % 3;
    const auto& vertex = triangles_[triangle].vertex;
    return vertex[k] + (vertex[(k + 1) % 3] - vertex[k]) * number(0, 1);
  }
  glm::dvec3 on(std::size_t triangle) {
    const auto& vertex = triangles_[triangle].vertex;
    double u = number(0, 1);
    double v = number(0, 1);
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    return vertex[0] + (vertex[1] - vertex[0]) * u + (vertex[2] - vertex[0]) * v;
  }

  std::vector<testbench::Triangle> triangles_;
  std::vector<std::int32_t> faces_;
  testbench::Box box_;
  std::mt19937_64 random_;
};

}  // namespace test_support
