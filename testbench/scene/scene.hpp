#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <string>
#include <vector>

namespace testbench {

/// A Lambertian surface; emission leaves the front side only (the side the counter-clockwise winding faces).
struct Material {
  std::string name;
  glm::dvec3 reflectance{0.0};  ///< linear RGB, each in [0, 1]
  glm::dvec3 emission{0.0};     ///< radiance, linear RGB, not negative
};

struct Triangle {
  glm::dvec3 vertex[3];
  std::int32_t material = 0;  ///< index into Scene::materials
};

/// A pinhole. Looking along `direction`, the picture's right is cross(direction, up): pixel x grows that way,
/// pixel y grows down, along -up. (So with direction +z and up +y, larger world x lies to the left of the
/// picture.)
struct Camera {
  glm::dvec3 position{0.0};
  glm::dvec3 direction{0.0, 0.0, 1.0};  ///< unit length
  glm::dvec3 up{0.0, 1.0, 0.0};         ///< unit length, orthogonal to direction
  double vertical_field_of_view_radians = 0.0;
};

struct FilmSize {
  int width = 0;
  int height = 0;
};

/// What a render needs of a scene, independent of the files it came from. Lengths are in the scene's own
/// unit.
struct Scene {
  std::string name;
  Camera camera;
  FilmSize film;
  std::vector<Material> materials;
  std::vector<Triangle> triangles;       ///< none degenerate (zero area)
  std::size_t degenerate_triangles = 0;  ///< how many the loader dropped
};

}  // namespace testbench
