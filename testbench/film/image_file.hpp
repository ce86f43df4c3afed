#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "testbench/film/film.hpp"
#include "testbench/texture/image.hpp"

namespace testbench {

/// Writes an OpenEXR file, top row first, ZIP compressed: float32 channels R, G, B (mean radiance) and
/// variance.R, variance.G, variance.B (variance of the mean), uint32 channel `samples`. `attributes` become
/// string attributes of the header; a name OpenEXR itself uses (`channels`, ...) or an empty one is refused
/// (std::invalid_argument). Atomic; throws InputError or RunError as write_atomically() does.
void write_exr(const std::filesystem::path& path, const Film& film,
               const std::map<std::string, std::string>& attributes);

/// Writes an 8-bit PNG, top row first: mean radiance clamped to [0, 1] (exposure 1) through the sRGB transfer
/// curve of IEC 61966-2-1, rounded to nearest. Atomic; throws as write_exr().
void write_png(const std::filesystem::path& path, const Film& film);

/// The 8-bit sRGB code of a linear value, as write_png() stores it.
int srgb_code(double linear);

/// Reads channels R, G and B of an OpenEXR file of the size of a film. Throws InputError if it cannot be read
/// or a channel is missing.
RadianceImage read_exr_rgb(const std::filesystem::path& path);

/// The content of a file of write_exr().
struct ExrFilm {
  int width = 0;
  int height = 0;
  std::vector<float> rgb;       ///< mean radiance
  std::vector<float> variance;  ///< variance of the mean, in the order of `rgb`; 0 in a file without it
  std::map<std::string, std::string> attributes;
};

/// Reads mean, variance and string attributes of a file of write_exr(), or of another program's that has R, G
/// and B. Throws InputError as read_exr_rgb() does.
ExrFilm read_exr_film(const std::filesystem::path& path);

}  // namespace testbench
