#include "testbench/film/error_curve.hpp"

#include <cmath>
#include <limits>

#include "testbench/film/flip.hpp"

namespace testbench {

namespace {

/// Mean over the pixels that count.
double mean_flip(const std::vector<double>& rgb, const ExrFilm& reference, const std::vector<bool>& counts) {
  const FilmSize size{reference.width, reference.height};
  const std::vector<double> truth(reference.rgb.begin(), reference.rgb.end());
  const std::vector<double> map = flip(display_image(size, rgb), display_image(size, truth));
  double sum = 0;
  double pixels = 0;
  for (std::size_t pixel = 0; pixel < map.size(); ++pixel) {
    if (!counts[pixel]) continue;
    sum += map[pixel];
    ++pixels;
  }
  return sum / pixels;
}

}  // namespace

ImageError image_error(const std::vector<double>& rgb, const ExrFilm& reference,
                       const std::vector<bool>& counts) {
  ImageError error;
  double sums[3] = {0, 0, 0};
  double reference_sums[3] = {0, 0, 0};
  double values = 0;
  for (std::size_t index = 0; index < rgb.size(); ++index) {
    if (!counts[index / 3]) continue;
    const double truth = reference.rgb[index];
    const double difference = rgb[index] - truth;
    const double squared = difference * difference - double(reference.variance[index]);
    error.mse += squared;
    error.relative_mse += squared / (truth * truth + ImageError::kRelativeOffset);
    sums[index % 3] += rgb[index];
    reference_sums[index % 3] += truth;
    ++values;
  }
  error.mse /= values;
  error.relative_mse /= values;
  for (int channel = 0; channel < 3; ++channel)
    error.mean_bias[channel] = reference_sums[channel] > 0 ? sums[channel] / reference_sums[channel] - 1
                                                           : std::numeric_limits<double>::quiet_NaN();
  error.flip = mean_flip(rgb, reference, counts);
  return error;
}

ImageError image_error(const Film& film, const ExrFilm& reference, const std::vector<bool>& counts) {
  return image_error(film.rgb(), reference, counts);
}

double log_log_slope(const std::vector<double>& x, const std::vector<double>& y) {
  double n = 0, sum_x = 0, sum_y = 0, sum_xx = 0, sum_xy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (!(x[i] > 0 && y[i] > 0)) continue;
    const double log_x = std::log(x[i]);
    const double log_y = std::log(y[i]);
    ++n;
    sum_x += log_x;
    sum_y += log_y;
    sum_xx += log_x * log_x;
    sum_xy += log_x * log_y;
  }
  const double spread = n * sum_xx - sum_x * sum_x;
  if (!(spread > 0)) return std::numeric_limits<double>::quiet_NaN();
  return (n * sum_xy - sum_x * sum_y) / spread;
}

}  // namespace testbench
