#pragma once

#include <cstdint>

#include "firmware/cn/chip/mono_memory.hpp"
#include "firmware/cn/language/vec3.hpp"

/// Light that arrives from outside the scene.
namespace path_tracer {

/// In mono memory, a texel of the environment's image.
struct EnvironmentTexel {
  float red = 0;  ///< radiance
  float green = 0;
  float blue = 0;
  float pdf = 0;  ///< of shadow rays, by solid angle; 0 where none goes
};

/// In SRAM: the texel that a ray which hits nothing sees.
struct EnvironmentLookUp {
  cn::MonoAddress place = 0;
  EnvironmentTexel texel{};
};

/// The environment's image by longitude and latitude: +y of its own directions in the top row, -z in the
/// middle column, +x to the right of it.
struct EnvironmentImage {
  cn::vec3<double> x_axis{1, 0, 0};  ///< of the image's directions, in the scene
  cn::vec3<double> y_axis{0, 1, 0};
  cn::vec3<double> z_axis{0, 0, 1};
  std::int32_t width = 1;  ///< in texels
  std::int32_t height = 1;
  cn::MonoAddress texels = 0;  ///< EnvironmentTexels row by row
};

/// A disk in the sky, as rays see it that hit nothing.
struct SunRecord {
  cn::vec3<double> direction{};  ///< towards its middle, unit length
  cn::vec3<double> radiance{};
  double cosine = 1;  ///< of half its angle
};

}  // namespace path_tracer
