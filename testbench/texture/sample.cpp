#include "testbench/texture/sample.hpp"

#include <array>
#include <cmath>

namespace testbench {
namespace {

/// The linear values of all codes: the curve's power is slow.
std::array<double, 256> linear_of_srgb_codes() {
  std::array<double, 256> linear{};
  for (std::size_t code = 0; code < linear.size(); ++code) {
    const double encoded = double(code) / 255.0;
    linear[code] = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
  }
  return linear;
}

glm::dvec4 wrapped_texel(const Texture& texture, const TextureReference& reference, double x, double y) {
  return texel_at(texture, wrapped_index(x, texture.image.width, reference.wrap_u),
                  wrapped_index(y, texture.image.height, reference.wrap_v));
}

}  // namespace

glm::dvec2 transformed(const TextureTransform& transform, const glm::dvec2& coordinates) {
  const double u = transform.scale.x * coordinates.x;
  const double v = transform.scale.y * coordinates.y;
  const double cosine = std::cos(transform.rotation_radians);
  const double sine = std::sin(transform.rotation_radians);
  return {transform.offset.x + cosine * u + sine * v, transform.offset.y - sine * u + cosine * v};
}

int wrapped_index(double index, int size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp_to_edge)
    return index <= 0.0 ? 0 : index >= size - 1.0 ? size - 1 : static_cast<int>(index);
  const int period = wrap == TextureWrap::repeat ? size : 2 * size;
  int place = static_cast<int>(std::fmod(index, period));
  if (place < 0) place += period;
  return place < size ? place : period - 1 - place;
}

double linear_of_srgb(std::uint8_t code) {
  static const std::array<double, 256> linear = linear_of_srgb_codes();
  return linear[code];
}

glm::dvec4 texel_at(const Texture& texture, int x, int y) {
  const Image& image = texture.image;
  const auto channels = std::size_t(image.channels);
  const std::uint8_t* const texel =
      &image.texels[(std::size_t(y) * std::size_t(image.width) + std::size_t(x)) * channels];
  const auto decoded = [&](std::size_t channel) {
    return texture.encoding == TexelEncoding::srgb ? linear_of_srgb(texel[channel]) : texel[channel] / 255.0;
  };
  const double alpha = has_alpha(image) ? texel[channels - 1] / 255.0 : 1.0;
  if (channels <= 2) return {glm::dvec3(decoded(0)), alpha};
  return {decoded(0), decoded(1), decoded(2), alpha};
}

glm::dvec4 sample_texture(const Texture& texture, const TextureReference& reference,
                          const glm::dvec2& coordinates) {
  glm::dvec2 place = transformed(reference.transform, coordinates);
  for (int axis = 0; axis < 2; ++axis)
    if (!std::isfinite(place[axis])) place[axis] = 0.0;
  const double x = place.x * texture.image.width;
  const double y = place.y * texture.image.height;
  if (reference.filter == TextureFilter::nearest)
    return wrapped_texel(texture, reference, std::floor(x), std::floor(y));
  // Centres of texels lie at halves.
  const double left = std::floor(x - 0.5);
  const double top = std::floor(y - 0.5);
  const double right_share = x - 0.5 - left;
  const double lower_share = y - 0.5 - top;
  const auto row = [&](double at) {
    return glm::mix(wrapped_texel(texture, reference, left, at),
                    wrapped_texel(texture, reference, left + 1.0, at), right_share);
  };
  return glm::mix(row(top), row(top + 1.0), lower_share);
}

}  // namespace testbench
