#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "testbench/texture/image.hpp"

// Lights that are no triangles. Radiance, intensity and irradiance are in one unit, that of
// Material::emission (in glTF candela a square metre), times steradians and areas in the scene's unit of
// length.

namespace testbench {

enum class LightKind : std::uint8_t {
  point,
  spot,
  directional,  ///< parallel light from infinitely far away
  sun           ///< light from a disk in the sky
};

/// A light without area, in the terms of glTF's KHR_lights_punctual, or a sun.
struct Light {
  std::string name;
  LightKind kind = LightKind::point;
  /// Linear RGB: of a point or spot, radiant intensity, what it sends out by steradian; of a directional one
  /// or a sun, the irradiance of a surface that faces it.
  glm::dvec3 intensity{1.0};
  glm::dvec3 position{0.0};               ///< of a point or spot
  glm::dvec3 direction{0.0, 0.0, -1.0};   ///< that its light travels in, unit length; not of a point
  double inner_cone_radians = 0.0;        ///< of a spot: half angle within which it is bright
  double outer_cone_radians = 0.0;        ///< of a spot: half angle beyond which it is dark
  double angular_diameter_radians = 0.0;  ///< of a sun
};

/// The share of its intensity that a spot sends into a direction at this angle from its axis
/// (KHR_lights_punctual, "Inner and Outer Cone Angles"). @param cosine of the angle
double spot_share(const Light& spot, double cosine);

/// Light from all directions, infinitely far away.
struct Environment {
  glm::dvec3 constant{0.0};            ///< radiance, linear RGB; counts if there is no image
  std::optional<RadianceImage> image;  ///< radiance by direction, see environment_place()
  double scale = 1.0;                  ///< multiplies the image
  glm::dmat3 rotation{1.0};            ///< from the image's directions to the scene's

  /// Whether it lights anything; a black image may not.
  bool is_lit() const { return image || constant != glm::dvec3(0.0); }
  /// Whether it has an image that is not black.
  bool shows_image() const;
};

/// Where in an environment's image a direction of the image lies, from (0, 0), the upper left corner, to
/// (1, 1): longitude and latitude, +y in the top row, -z in the middle, +x to the right of it.
/// @param direction unit length
glm::dvec2 environment_place(const glm::dvec3& direction);

/// The direction of a place; the inverse of environment_place().
glm::dvec3 environment_direction(const glm::dvec2& place);

/// The radiance that comes from a direction of the scene (unit length): the pixel that it lies in.
glm::dvec3 environment_radiance(const Environment& environment, const glm::dvec3& direction);

}  // namespace testbench
