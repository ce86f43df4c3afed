#include "testbench/film/image_agreement.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace testbench {
namespace {

/// Sums over the pixels of a part of two films.
struct PartSums {
  glm::dvec3 first = glm::dvec3(0);
  glm::dvec3 difference = glm::dvec3(0);
  glm::dvec3 variance = glm::dvec3(0);  ///< of the difference

  void add(const Film& a, const Film& b, int pixel) {
    first += a.mean(pixel);
    difference += b.mean(pixel) - a.mean(pixel);
    variance += a.variance_of_mean(pixel) + b.variance_of_mean(pixel);
  }
  double z(int channel) const {
    if (difference[channel] == 0) return 0;
    if (variance[channel] == 0) return std::numeric_limits<double>::infinity();
    return difference[channel] / std::sqrt(variance[channel]);
  }
};

PartSums tile_sums(const Film& first, const Film& second, int left, int top) {
  const FilmSize size = first.size();
  PartSums sums;
  for (int y = top; y < std::min(top + ImageAgreement::kTileSide, size.height); ++y)
    for (int x = left; x < std::min(left + ImageAgreement::kTileSide, size.width); ++x)
      sums.add(first, second, y * size.width + x);
  return sums;
}

void compare_images(const Film& first, const Film& second, ImageAgreement& agreement) {
  PartSums sums;
  for (int pixel = 0; pixel < first.pixel_count(); ++pixel) sums.add(first, second, pixel);
  for (int channel = 0; channel < 3; ++channel) {
    agreement.image_z[channel] = sums.z(channel);
    if (!(sums.first[channel] > 0)) continue;
    agreement.relative_difference[channel] = sums.difference[channel] / sums.first[channel];
    agreement.standard_error[channel] = std::sqrt(sums.variance[channel]) / sums.first[channel];
  }
}

void compare_tiles(const Film& first, const Film& second, ImageAgreement& agreement) {
  const FilmSize size = first.size();
  double squares = 0;
  int varying = 0;
  for (int top = 0; top < size.height; top += ImageAgreement::kTileSide)
    for (int left = 0; left < size.width; left += ImageAgreement::kTileSide) {
      const PartSums sums = tile_sums(first, second, left, top);
      ++agreement.tiles;
      for (int channel = 0; channel < 3; ++channel) {
        const double z = sums.z(channel);
        agreement.largest_tile_z = std::max(agreement.largest_tile_z, std::abs(z));
        if (sums.variance[channel] == 0) continue;
        squares += z * z;
        ++varying;
      }
    }
  agreement.tile_rms_z = varying == 0 ? 0 : std::sqrt(squares / varying);
}

}  // namespace

bool ImageAgreement::holds() const {
  const auto is_near = [](double z) { return std::abs(z) <= kLargestImageZ; };
  return std::all_of(std::begin(image_z), std::end(image_z), is_near) && largest_tile_z <= kLargestTileZ;
}

std::string ImageAgreement::text() const {
  std::string text = "difference of the means R, G, B:";
  char part[96];
  for (int channel = 0; channel < 3; ++channel) {
    std::snprintf(part, sizeof(part), " %+.3f +- %.3f %% (z %+.2f)", 100 * relative_difference[channel],
                  100 * standard_error[channel], image_z[channel]);
    text += part;
  }
  std::snprintf(part, sizeof(part), "\nz of %d tiles: root mean square %.2f, largest %.2f (allowed %.1f)\n",
                tiles, tile_rms_z, largest_tile_z, kLargestTileZ);
  return text + part;
}

ImageAgreement agreement_of(const Film& first, const Film& second) {
  ImageAgreement agreement;
  compare_images(first, second, agreement);
  compare_tiles(first, second, agreement);
  return agreement;
}

}  // namespace testbench
