#pragma once

#include <string>

#include "testbench/film/film.hpp"

namespace testbench {

/// Whether two independent renders of a scene have the same mean, by the variance that each found in its own
/// samples. Differences are in standard errors (z).
struct ImageAgreement {
  static constexpr int kTileSide = 8;  ///< pixels; tiles at the right and lower border may be smaller
  /// Normal numbers exceed these once in 50,000 comparisons of the image's three means and once in
  /// 500,000,000 of a tile's.
  static constexpr double kLargestImageZ = 4.5;
  static constexpr double kLargestTileZ = 6;

  double relative_difference[3] = {0, 0, 0};  ///< for R, G, B: mean of the second image / of the first - 1
  double standard_error[3] = {0, 0, 0};       ///< of the relative difference
  double image_z[3] = {0, 0, 0};
  int tiles = 0;
  double largest_tile_z = 0;  ///< of all tiles and channels, without its sign
  double tile_rms_z = 0;      ///< about 1 for equal means; over what varies

  bool holds() const;
  /// Lines for people.
  std::string text() const;
};

/// Both films must be of one size and keep variances. What does not vary must be equal.
ImageAgreement agreement_of(const Film& first, const Film& second);

}  // namespace testbench
