#include "testbench/sampling/error_estimate.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace testbench {
namespace {

/// What is known of a pixel from its own samples; of several pixels, sums.
struct PixelMoments {
  glm::dvec3 mean{0.0};
  glm::dvec3 variance{0.0};            ///< of a sample
  glm::dvec3 variance_of_splats{0.0};  ///< of what one sample of each pixel brings
  double pixels = 0;                   ///< with two samples or more

  void add(const PixelMoments& other) {
    mean += other.mean;
    variance += other.variance;
    variance_of_splats += other.variance_of_splats;
    pixels += other.pixels;
  }
};

std::vector<PixelMoments> moments_of(const Film& film) {
  std::vector<PixelMoments> all(std::size_t(film.pixel_count()));
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    const std::uint64_t samples = film.sample_count(pixel);
    if (samples < 2) continue;
    const glm::dvec3 of_splats = film.variance_of_splats(pixel);
    const glm::dvec3 of_samples = film.variance_of_mean(pixel) - of_splats;
    all[std::size_t(pixel)] = {film.mean(pixel), of_samples * double(samples),
                               of_splats * film.samples_for_each_pixel(), 1};
  }
  return all;
}

PixelMoments sum(const std::vector<PixelMoments>& all) {
  PixelMoments total;
  for (const PixelMoments& moments : all) total.add(moments);
  return total;
}

/// The sums over the pixels around one, without it.
PixelMoments around(const std::vector<PixelMoments>& all, FilmSize size, int column, int row) {
  PixelMoments total;
  const int last_row = std::min(row + kDeviationRadius, size.height - 1);
  const int last_column = std::min(column + kDeviationRadius, size.width - 1);
  for (int y = std::max(row - kDeviationRadius, 0); y <= last_row; ++y)
    for (int x = std::max(column - kDeviationRadius, 0); x <= last_column; ++x)
      if (x != column || y != row) total.add(all[std::size_t(y) * std::size_t(size.width) + std::size_t(x)]);
  return total;
}

double deviation(const PixelMoments& sums, const glm::dvec3& variance, double dark) {
  double relative = 0;
  for (int channel = 0; channel < 3; ++channel) {
    const double mean = sums.mean[channel] / sums.pixels;
    const double bound = mean * mean + dark * dark;
    if (bound > 0) relative += variance[channel] / sums.pixels / bound;
  }
  return std::sqrt(relative / 3);
}

void raise_to_least(std::vector<double>& deviations) {
  const double mean = std::accumulate(deviations.begin(), deviations.end(), 0.0) / double(deviations.size());
  for (double& value : deviations) value = std::max(value, kLeastDeviation * mean);
}

}  // namespace

SampleDeviations sample_deviations(const Film& film) {
  const std::vector<PixelMoments> all = moments_of(film);
  const PixelMoments whole = sum(all);
  const FilmSize size = film.size();
  SampleDeviations deviations{std::vector<double>(all.size(), 0.0), std::vector<double>(all.size(), 0.0)};
  if (whole.pixels == 0) return deviations;
  const double dark = kDarkShare * (whole.mean.x + whole.mean.y + whole.mean.z) / (3 * whole.pixels);
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column) {
      const PixelMoments around_it = around(all, size, column, row);
      const PixelMoments& near = around_it.pixels > 0 ? around_it : whole;
      const std::size_t pixel = std::size_t(row) * std::size_t(size.width) + std::size_t(column);
      deviations.of_sample[pixel] = deviation(near, near.variance, dark);
      deviations.of_splats[pixel] = deviation(near, near.variance_of_splats, dark);
    }
  raise_to_least(deviations.of_sample);
  return deviations;
}

double picture_error(const SampleDeviations& deviations, const std::vector<double>& importance,
                     const MeanSamples& samples) {
  const double mean = total(samples) / double(samples.size());
  double squares = 0;
  double weights = 0;
  for (std::size_t pixel = 0; pixel < samples.size(); ++pixel) {
    if (!(samples[pixel] > 0)) continue;
    const double of_sample = deviations.of_sample[pixel];
    const double of_splats = deviations.of_splats[pixel];
    squares += importance[pixel] * (of_sample * of_sample / samples[pixel] + of_splats * of_splats / mean);
    weights += importance[pixel];
  }
  return weights > 0 ? std::sqrt(squares / weights) : 0;
}

}  // namespace testbench
