#pragma once

#include <array>
#include <cstdint>

#include "testbench/scene/scene.hpp"

/// Scenes that tests build without files.
namespace test_support {

using testbench::FilmSize;
using testbench::Scene;

/// The cube from -1 to 1, wound so that its inside is the front: 12 triangles of one grey material. The
/// camera is inside, off centre, and sees faces, edges and a corner.
Scene closed_cube(double albedo, double emission, FilmSize film);

/// The same with an octahedron subdivided onto the unit sphere: 8 * 4^levels triangles. Every point sees
/// every other one under equal cosines, so light sampling has hardly any variance; at a cube's edges its
/// variance is infinite.
Scene closed_sphere(double albedo, double emission, int levels, FilmSize film);

/// A square light that faces down and reflects nothing, with half side `kLightHalfSide`, at height
/// `kLightHeight` above the plane y = 0.
struct PlaneAndLight {
  static constexpr double kLightHalfSide = 1.0;
  static constexpr double kLightHeight = 2.0;
  glm::dvec3 reflectance;  ///< reflectance of the plane
  glm::dvec3 radiance;     ///< radiance of the light
};

/// The camera looks down onto the plane from below the light: every pixel lies on the plane.
Scene plane_under_light(const PlaneAndLight& values, FilmSize film);
/// The camera looks up at the light's front, around which the scene is empty. At the light there are
/// film.height / 8 pixels per unit of length, so the light's edges lie on pixel borders if the film's height
/// is a multiple of 8.
Scene light_from_below(const PlaneAndLight& values, FilmSize film);
/// The camera looks down at the light's back in the same way; the plane surrounds it.
Scene light_from_above(const PlaneAndLight& values, FilmSize film);
/// The plane lies above the light and faces down, and the camera between the two looks up at it. No light
/// reaches the plane.
Scene plane_over_light(const PlaneAndLight& values, FilmSize film);

/// A grey sphere of 4 * rings * (rings - 1) triangles in an open box under a square light.
Scene sphere_under_light(int rings, FilmSize film);

/// Random triangles in front of the camera, some of which emit; the same on every machine.
Scene triangle_soup(int triangles, std::uint64_t seed, FilmSize film);

/// scenes/cornell_box with a smaller film.
Scene small_cornell_box(FilmSize film);

/// A texture of random texels.
testbench::Texture random_texture(int width, int height, int channels, testbench::TexelEncoding encoding);

/// Adds two triangles with texture coordinates in set 0, counter-clockwise as seen from the front; (0, 0) is
/// at the last corner.
void add_textured_square(testbench::Scene& scene, const std::array<glm::dvec3, 4>& corners,
                         std::int32_t material);

/// A square whose reflectance is a texture with a texel for each pixel of the film, which it fills, under a
/// sky of radiance 1.
testbench::Scene textured_square(testbench::FilmSize film, testbench::TextureFilter filter);

/// Leaning squares with textures in every slot, wrapped and filtered in every way, under a sky and a light.
testbench::Scene textured_squares(testbench::FilmSize film, bool has_textured_light = false);

}  // namespace test_support
