#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "testbench/material/light.hpp"
#include "testbench/material/material.hpp"
#include "testbench/scene/corner_attributes.hpp"
#include "testbench/system/notes.hpp"
#include "testbench/texture/texture.hpp"

namespace testbench {

struct Triangle {
  glm::dvec3 vertex[3];
  std::int32_t material = 0;  ///< index into Scene::materials
};

/// Which of so many materials the triangles have.
inline std::vector<bool> materials_in_use(const std::vector<Triangle>& triangles, std::size_t materials) {
  std::vector<bool> in_use(materials, false);
  for (const Triangle& triangle : triangles) in_use[std::size_t(triangle.material)] = true;
  return in_use;
}

/// A pinhole camera, or an orthographic one, whose rays are parallel. Pixel x grows along cross(direction,
/// up), to the right of a viewer who looks along `direction`; pixel y grows along -up. So with direction +z
/// and up +y, larger world x lies further left in the picture.
struct Camera {
  glm::dvec3 position{0.0};                     ///< of the pinhole, or of the orthographic film's centre
  glm::dvec3 direction{0.0, 0.0, 1.0};          ///< unit length
  glm::dvec3 up{0.0, 1.0, 0.0};                 ///< unit length, orthogonal to direction
  double vertical_field_of_view_radians = 0.0;  ///< of a pinhole camera
  /// Height of the film in the scene, which makes the camera orthographic: rays start on the film and run
  /// along `direction`, and what lies behind the film is not seen.
  std::optional<double> orthographic_height;
};

/// Largest width or height of a film, in pixels.
inline constexpr int kMaxFilmSide = 16384;
/// Width and height of a film for which the scene names none, in pixels.
inline constexpr int kDefaultFilmSide = 480;

/// Width and height in pixels.
struct FilmSize {
  int width = 0;
  int height = 0;
};

/// All that a render needs of a scene, independent of its files. Lengths are in the scene's own unit.
struct Scene {
  std::string name;
  Camera camera;
  FilmSize film;
  std::vector<Material> materials;
  std::vector<Triangle> triangles;  ///< none of zero area
  CornerAttributes corners;         ///< of the triangles
  std::vector<Texture> textures;    ///< that the materials use
  Environment environment;
  std::vector<Light> lights;             ///< that are no triangles
  std::size_t degenerate_triangles = 0;  ///< number of triangles of zero area that the loader dropped
  std::size_t coincident_triangles = 0;  ///< number that lie on others, as the loader found
  /// Vertices were rounded to doubles where coordinates had this size, in the scene's unit, if it is more
  /// than what they have (normalised()).
  double rounded_at = 0;
  Notes notes;                               ///< what the loader left out or replaced
  std::vector<std::filesystem::path> files;  ///< that the loader read or that these name
};

}  // namespace testbench
