#include "testbench/film/black_film.hpp"

#include <algorithm>
#include <cfloat>
#include <cmath>
#include <limits>
#include <vector>

#include "testbench/mono_image/faces.hpp"
#include "testbench/scene/film_ray.hpp"
#include "testbench/scene/normalise.hpp"

namespace testbench {
namespace {

/// Rays through the centres of a grid of this side, spread over the film.
constexpr int kGridSide = 8;

struct ViewedPoint {
  const Triangle* triangle;
  glm::dvec3 point;
  bool from_behind;
};

const Material& material_in(const Scene& scene, const Triangle& triangle) {
  return scene.materials[std::size_t(triangle.material)];
}

bool is_light(const Scene& scene, const Triangle& triangle) {
  return material_in(scene, triangle).emission != glm::dvec3(0.0);
}

/// Distance along the ray, or infinity (Moeller and Trumbore 1997).
double distance_to(const Triangle& triangle, const glm::dvec3& origin, const glm::dvec3& direction) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const glm::dvec3 edge1 = triangle.vertex[1] - triangle.vertex[0];
  const glm::dvec3 edge2 = triangle.vertex[2] - triangle.vertex[0];
  const glm::dvec3 p = glm::cross(direction, edge2);
  const double determinant = glm::dot(edge1, p);
  if (determinant == 0) return kNone;
  const glm::dvec3 from = origin - triangle.vertex[0];
  const double u = glm::dot(from, p) / determinant;
  const glm::dvec3 q = glm::cross(from, edge1);
  const double v = glm::dot(direction, q) / determinant;
  const double distance = glm::dot(edge2, q) / determinant;
  return u >= 0 && v >= 0 && u + v <= 1 && distance > 0 ? distance : kNone;
}

/// What the rays of the grid meet; rays that leave the scene are left out.
std::vector<ViewedPoint> viewed_points(const Scene& scene) {
  std::vector<ViewedPoint> points;
  for (int cell = 0; cell < kGridSide * kGridSide; ++cell) {
    const auto place = [](int i, int pixels) { return (i + 0.5) / kGridSide * pixels; };
    const FilmRay ray = film_ray(scene, place(cell % kGridSide, scene.film.width),
                                 place(cell / kGridSide, scene.film.height));
    double nearest = std::numeric_limits<double>::infinity();
    const Triangle* hit = nullptr;
    for (const Triangle& triangle : scene.triangles)
      if (const double distance = distance_to(triangle, ray.origin, ray.direction); distance < nearest) {
        nearest = distance;
        hit = &triangle;
      }
    if (hit != nullptr)
      points.push_back(
          {hit, ray.origin + nearest * ray.direction, glm::dot(area_normal(*hit), ray.direction) > 0});
  }
  return points;
}

bool faces(const Triangle& light, const glm::dvec3& point) {
  return glm::dot(area_normal(light), point - light.vertex[0]) > 0;
}

/// Whether the front of any light looks at the camera or at a point that the camera sees. Lights without
/// triangles may look anywhere.
bool any_light_faces(const Scene& scene, const std::vector<ViewedPoint>& points) {
  if (!scene.lights.empty() || scene.environment.is_lit()) return true;
  return std::any_of(scene.triangles.begin(), scene.triangles.end(), [&](const Triangle& light) {
    const auto is_faced = [&](const ViewedPoint& viewed) { return faces(light, viewed.point); };
    return is_light(scene, light) &&
           (faces(light, scene.camera.position) || std::any_of(points.begin(), points.end(), is_faced));
  });
}

bool has_only_lights_without_area(const Scene& scene) {
  return !scene.lights.empty() && !scene.environment.is_lit() &&
         std::none_of(scene.triangles.begin(), scene.triangles.end(),
                      [&](const Triangle& triangle) { return is_light(scene, triangle); });
}

/// why_black() of a scene in its normal unit.
std::string reason_of_black(const Scene& scene, bool casts_shadow_rays) {
  const std::vector<ViewedPoint> points = viewed_points(scene);
  if (points.empty()) return "the camera sees no surface; it may look away from the scene";
  if (!casts_shadow_rays && has_only_lights_without_area(scene))
    return "program segments casts no shadow rays, and no path hits a light without area";
  if (!any_light_faces(scene, points))
    return "every light faces away from what the camera sees; a light emits from the side from which its "
           "vertices run counter-clockwise";
  const auto is_from_behind = [](const ViewedPoint& viewed) { return viewed.from_behind; };
  const bool is_surrounded = points.size() == std::size_t(kGridSide) * kGridSide;
  if (is_surrounded && std::all_of(points.begin(), points.end(), is_from_behind))
    return "the camera sees back sides alone; it may be inside an object";
  const auto is_dark = [&](const ViewedPoint& viewed) {
    return material_in(scene, *viewed.triangle).reflectance == glm::dvec3(0.0);
  };
  if (std::all_of(points.begin(), points.end(), is_dark))
    return "the surfaces that the camera sees reflect no light";
  return "no path has met a light; lights may be hidden from what the camera sees, or more samples may find "
         "them";
}

}  // namespace

bool is_black(const Film& film) {
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel)
    if (film.mean(pixel) != glm::dvec3(0.0)) return false;
  return true;
}

bool is_below_single_precision(const Film& film) {
  double largest = 0.0;
  for (int pixel = 0; pixel < film.pixel_count() && largest < double(FLT_MIN); ++pixel) {
    const glm::dvec3 mean = film.mean(pixel);
    largest = std::max({largest, mean.x, mean.y, mean.z});
  }
  return largest > 0.0 && largest < double(FLT_MIN);
}

std::string why_black(const Scene& scene, bool casts_shadow_rays) {
  return reason_of_black(normalised(scene), casts_shadow_rays);
}

}  // namespace testbench
