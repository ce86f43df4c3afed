#include "testbench/sampling/importance_map.hpp"

#include <algorithm>

#include "testbench/film/film_size.hpp"
#include "testbench/system/error.hpp"
#include "testbench/texture/exr_file.hpp"

namespace testbench {
namespace {

constexpr double kLuminance[3] = {0.2126, 0.7152, 0.0722};  // of the primaries of Rec. ITU-R BT.709-6

std::string place_of(std::size_t pixel, FilmSize film) {
  const auto width = std::size_t(film.width);
  return "pixel (" + std::to_string(pixel % width) + ", " + std::to_string(pixel / width) + ")";
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

void require_importance(const std::vector<double>& importance, const std::filesystem::path& path,
                        FilmSize film) {
  const auto negative =
      std::find_if(importance.begin(), importance.end(), [](double value) { return value < 0; });
  if (negative != importance.end())
    throw InputError(path.string() + ": found importance " + std::to_string(*negative) + " in " +
                     place_of(std::size_t(negative - importance.begin()), film) +
                     "; allowed: finite numbers from 0");
  if (std::all_of(importance.begin(), importance.end(), [](double value) { return value == 0; }))
    throw InputError(path.string() +
                     ": found importance 0 in every pixel; allowed: at least one pixel above 0");
}

/// A colour whose luminance is a sum of positive and negative parts is refused by its negative part.
void require_colour(const std::vector<float>& rgb, const std::filesystem::path& path, FilmSize film) {
  for (std::size_t i = 0; i < rgb.size(); ++i)
    if (rgb[i] < 0)
      throw InputError(path.string() + ": " + kExrColour[i % 3] + ": found " + std::to_string(rgb[i]) +
                       " in " + place_of(i / 3, film) + "; allowed: finite numbers from 0");
}

std::vector<double> luminance(const std::vector<float>& rgb) {
  std::vector<double> values(rgb.size() / 3);
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
    for (std::size_t channel = 0; channel < 3; ++channel)
      values[pixel] += kLuminance[channel] * double(rgb[3 * pixel + channel]);
  return values;
}

/// The name of the channel that is the importance; "" if it is the luminance of a colour.
std::string grey_channel(const ExrFile& file) {
  const std::vector<std::string> names = file.channel_names();
  const auto has = [&](const char* name) {
    return std::find(names.begin(), names.end(), name) != names.end();
  };
  if (has("R") && has("G") && has("B")) return "";
  if (has("Y")) return "Y";
  return names.size() == 1 ? names.front() : "";
}

}  // namespace

std::vector<double> read_importance(const std::filesystem::path& path, FilmSize film) {
  const ExrFile file(path, {kMaxFilmSide, std::size_t{kMaxFilmSide} * kMaxFilmSide, allowed_film_size()});
  if (file.size().x != film.width || file.size().y != film.height)
    throw InputError(path.string() + ": found an importance map of " +
                     size_text(file.size().x, file.size().y) + " pixels; allowed is the film's size, " +
                     size_text(film.width, film.height));
  const std::string grey = grey_channel(file);
  std::vector<double> importance;
  if (grey.empty()) {
    const std::vector<float> rgb = file.channels({std::begin(kExrColour), std::end(kExrColour)});
    require_colour(rgb, path, film);
    importance = luminance(rgb);
  } else {
    const std::vector<float> values = file.channels({grey});
    importance.assign(values.begin(), values.end());
  }
  require_importance(importance, path, film);
  return importance;
}

void require_countable(const std::vector<double>& importance, int samples, const std::filesystem::path& path,
                       FilmSize film) {
  for (std::size_t pixel = 0; pixel < importance.size(); ++pixel)
    if (importance[pixel] * samples > kMostPixelSamples)
      throw InputError(path.string() + ": found importance " + std::to_string(importance[pixel]) + " in " +
                       place_of(pixel, film) + ", which times --samples is more than " +
                       std::to_string(int(kMostPixelSamples)) + " paths; allowed: less");
}

}  // namespace testbench
