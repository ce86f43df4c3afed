#pragma once

#include <cstdint>

#include "testbench/scene/scene.hpp"

/// Scenes that tests build without files.
namespace test_support {

using testbench::FilmSize;
using testbench::Scene;

/// The cube from -1 to 1, wound so that the inside is the front, 12 triangles of one grey material. The
/// camera is inside, off centre, and sees faces, edges and a corner.
Scene closed_cube(double albedo, double emission, FilmSize film);

/// The same of an octahedron subdivided onto the unit sphere: 8 * 4^levels triangles. Where every point sees
/// every other one under equal cosines the light sampling has hardly any variance; a cube's edges give it an
/// infinite one.
Scene closed_sphere(double albedo, double emission, int levels, FilmSize film);

/// A square light of half width `kLightHalfSide` at height `kLightHeight` above a plane y = 0, facing down;
/// it reflects nothing.
struct PlaneAndLight {
  static constexpr double kLightHalfSide = 1.0;
  static constexpr double kLightHeight = 2.0;
  glm::dvec3 reflectance;  ///< of the plane
  glm::dvec3 radiance;     ///< of the light
};

/// Looks down onto the plane from below the light: every pixel lies on the plane.
Scene plane_under_light(const PlaneAndLight& values, FilmSize film);
/// Looks up at the light's front: film pixels per unit of length at the light are film.height / 8, so the
/// light's edges lie on pixel borders of every film whose height is a multiple of 8. Around it there is
/// nothing.
Scene light_from_below(const PlaneAndLight& values, FilmSize film);
/// Looks down at the light's back, likewise; around it is the plane.
Scene light_from_above(const PlaneAndLight& values, FilmSize film);
/// The plane turned over and put above the light: between the two, looking up at it. Nothing lights it.
Scene plane_over_light(const PlaneAndLight& values, FilmSize film);

/// A grey sphere of triangles, 4 * rings * (rings - 1) of them, in an open box under a square light.
Scene sphere_under_light(int rings, FilmSize film);

/// Random triangles in front of the camera, some of which emit. The same numbers everywhere.
Scene triangle_soup(int triangles, std::uint64_t seed, FilmSize film);

/// scenes/cornell_box, smaller.
Scene small_cornell_box(FilmSize film);

}  // namespace test_support
