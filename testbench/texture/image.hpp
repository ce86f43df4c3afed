#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace testbench {

/// The largest width or height of an image that a scene names, in pixels.
inline constexpr int kMostImageSide = 16384;
/// The most pixels of such an image.
inline constexpr std::size_t kMostImagePixels = std::size_t{1} << 26;
/// What those two allow, for error messages.
inline constexpr const char* kAllowedImageSize =
    "1 to 16384 pixels wide and high, at most 67108864 (8192 x 8192) in all";

/// Whether an image may have this size.
constexpr bool is_allowed_image_size(std::int64_t width, std::int64_t height) {
  return width >= 1 && height >= 1 && width <= kMostImageSide && height <= kMostImageSide &&
         std::uint64_t(width) * std::uint64_t(height) <= kMostImagePixels;
}

/// An image of 8 bits a channel, row by row, the top row first. Its channels are grey, grey and alpha, RGB,
/// or RGB and alpha.
struct Image {
  int width = 0;
  int height = 0;
  int channels = 0;  ///< 1 to 4
  std::vector<std::uint8_t> texels;
};

inline bool has_alpha(const Image& image) {
  return image.channels % 2 == 0;
}

/// Linear R, G and B of each pixel, row by row, the top row first.
struct RadianceImage {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;
};

}  // namespace testbench
