#include "testbench/film/error_curve.hpp"

#include <cmath>
#include <limits>

namespace testbench {

ImageError image_error(const Film& film, const ExrFilm& reference, const std::vector<bool>& counts) {
  ImageError error;
  double sums[3] = {0, 0, 0};
  double reference_sums[3] = {0, 0, 0};
  double values = 0;
  for (int pixel = 0; pixel < film.pixel_count(); ++pixel) {
    if (!counts[static_cast<std::size_t>(pixel)]) continue;
    const glm::dvec3 mean = film.mean(pixel);
    for (int channel = 0; channel < 3; ++channel) {
      const std::size_t index = 3 * static_cast<std::size_t>(pixel) + static_cast<std::size_t>(channel);
      const double truth = reference.rgb[index];
      const double difference = mean[channel] - truth;
      const double squared = difference * difference - double(reference.variance[index]);
      error.mse += squared;
      error.relative_mse += squared / (truth * truth + ImageError::kRelativeOffset);
      sums[channel] += mean[channel];
      reference_sums[channel] += truth;
      ++values;
    }
  }
  error.mse /= values;
  error.relative_mse /= values;
  for (int channel = 0; channel < 3; ++channel)
    error.mean_bias[channel] = sums[channel] / reference_sums[channel] - 1;
  return error;
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
