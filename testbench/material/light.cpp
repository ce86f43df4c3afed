#include "testbench/material/light.hpp"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace testbench {

double spot_share(const Light& spot, double cosine) {
  const double inner = std::cos(spot.inner_cone_radians);
  const double outer = std::cos(spot.outer_cone_radians);
  if (cosine >= inner) return 1.0;
  if (cosine <= outer) return 0.0;
  const double share = (cosine - outer) / (inner - outer);
  return share * share;
}

bool Environment::shows_image() const {
  return image && scale > 0.0 &&
         std::any_of(image->rgb.begin(), image->rgb.end(), [](float channel) { return channel > 0.0f; });
}

glm::dvec2 environment_place(const glm::dvec3& direction) {
  const double longitude = std::atan2(direction.x, -direction.z);
  const double colatitude = std::atan2(std::hypot(direction.x, direction.z), direction.y);
  return {0.5 + longitude / (2.0 * glm::pi<double>()), colatitude / glm::pi<double>()};
}

glm::dvec3 environment_direction(const glm::dvec2& place) {
  const double longitude = (place.x - 0.5) * (2.0 * glm::pi<double>());
  const double colatitude = place.y * glm::pi<double>();
  const double horizontal = std::sin(colatitude);
  return {horizontal * std::sin(longitude), std::cos(colatitude), -horizontal * std::cos(longitude)};
}

glm::dvec3 environment_radiance(const Environment& environment, const glm::dvec3& direction) {
  if (!environment.image) return environment.constant;
  const RadianceImage& image = *environment.image;
  const glm::dvec2 place = environment_place(glm::transpose(environment.rotation) * direction);
  const auto pixel = [](double share, int size) {
    return std::size_t(std::clamp(static_cast<int>(share * size), 0, size - 1));
  };
  const std::size_t index =
      pixel(place.y, image.height) * std::size_t(image.width) + pixel(place.x, image.width);
  const float* const rgb = &image.rgb[3 * index];
  return environment.scale * glm::dvec3(rgb[0], rgb[1], rgb[2]);
}

}  // namespace testbench
