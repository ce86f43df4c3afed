#include "testbench/texture/radiance_image.hpp"

#include <algorithm>
#include <cmath>

#include "testbench/files/input_file.hpp"
#include "testbench/texture/exr_file.hpp"
#include "testbench/texture/hdr_file.hpp"
#include "testbench/texture/image_decoder.hpp"

namespace testbench {
namespace {

constexpr std::uint64_t kMostHdrBytes = std::uint64_t{1} << 30;

void require_light(const RadianceImage& image, const std::string& file) {
  for (std::size_t i = 0; i < image.rgb.size(); ++i) {
    if (image.rgb[i] >= 0.0f && std::isfinite(image.rgb[i])) continue;
    const std::size_t pixel = i / 3;
    const auto width = std::size_t(image.width);
    fail_at_image(file,
                  "radiance " + std::to_string(image.rgb[i]) + " in pixel (" + std::to_string(pixel % width) +
                      ", " + std::to_string(pixel / width) + ")",
                  "finite numbers from 0");
  }
  if (std::all_of(image.rgb.begin(), image.rgb.end(), [](float value) { return value == 0.0f; }))
    fail_at_image(file, "an environment without light, 0 in every pixel", "one that is not black");
}

}  // namespace

RadianceImage read_radiance_image(const std::filesystem::path& path) {
  constexpr const char* kAllowed = "an OpenEXR or Radiance HDR file";
  const std::string file = path.string();
  const std::string bytes = read_input_file(path, kAllowed, kMostHdrBytes);
  constexpr std::string_view kExrStart("\x76\x2f\x31\x01", 4);
  RadianceImage image;
  if (std::string_view(bytes).substr(0, 4) == kExrStart)
    image = read_exr_rgb(path, {kMostImageSide, kMostImagePixels, kAllowedImageSize});
  else if (is_hdr(bytes))
    image = decode_hdr(bytes, file);
  else
    fail_at_image(file, bytes.empty() ? "an empty file" : "a file in another format", kAllowed);
  require_light(image, file);
  return image;
}

}  // namespace testbench
