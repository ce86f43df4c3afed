#pragma once

#include <vector>

#include "testbench/film/film.hpp"
#include "testbench/sampling/sample_counts.hpp"

namespace testbench {

/// What is known of a picture's noise, of each pixel.
struct SampleDeviations {
  std::vector<double> of_sample;  ///< of the pixel's own
  /// Of what the light path of a sample of each pixel brings to this one (Film::add_splat): all samples lower
  /// it alike, wherever they are.
  std::vector<double> of_splats;
};

/// The relative deviation of one sample of each pixel: the root of the mean over R, G and B of
///
///     variance of a sample / (mean^2 + (kDarkShare * the picture's mean luminance)^2)
///
/// where the last term bounds the weight of dark pixels (Rousselle, Knaus, Zwicker, SIGGRAPH Asia 2011).
/// Variance and mean are averages over the pixels around, kDeviationRadius to each side, without the pixel's
/// own samples: so the number of its further samples depends on none of its own values, and their mean stays
/// unbiased. No deviation is below kLeastDeviation of the average one, so that no region whose first samples
/// have missed the light is given up.
///
/// @param film with variances
SampleDeviations sample_deviations(const Film& film);

inline constexpr double kDarkShare = 0.1;
inline constexpr int kDeviationRadius = 2;
inline constexpr double kLeastDeviation = 0.25;

/// The relative RMSE of a picture whose pixels have so many samples: the root of the mean over the pixels,
/// weighted by their importance, of of_sample^2 / samples + of_splats^2 / the mean of samples. Pixels without
/// samples do not count.
double picture_error(const SampleDeviations& deviations, const std::vector<double>& importance,
                     const MeanSamples& samples);

}  // namespace testbench
