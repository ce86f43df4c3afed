#pragma once

#include <optional>
#include <vector>

#include "testbench/film/film.hpp"
#include "testbench/film/image_file.hpp"

namespace testbench {

/// How far an image is from the truth: means over channels of unmasked pixels.
struct ImageError {
  double mse = 0;                   ///< of linear radiance
  double relative_mse = 0;          ///< squared difference / (squared reference + kRelativeOffset)
  double mean_bias[3] = {0, 0, 0};  ///< of R, G and B: (mean of the image / mean of the reference) - 1

  /// Keeps dark pixels from counting without bound (Rousselle, Knaus, Zwicker, SIGGRAPH Asia 2011).
  static constexpr double kRelativeOffset = 1e-2;
};

/// Error of a film against a reference of the same size. The reference's samples are independent, so the
/// variance that it holds is what its noise adds to the squared difference; that is subtracted. An error
/// below the noise's own scatter may come out negative. `counts` says which pixels count, one entry a pixel;
/// at least one must.
ImageError image_error(const Film& film, const ExrFilm& reference, const std::vector<bool>& counts);

/// One line of an error curve.
struct CurvePoint {
  int samples = 0;  ///< a pixel
  ImageError error;
  double native_cpu_seconds = 0;            ///< of rendering
  std::optional<double> timed_cpu_seconds;  ///< with the chip's timing on
  std::optional<double> simulated_seconds;  ///< on the chip
};

/// Slope of log y over log x by least squares over the points where both are positive; NaN with fewer than
/// two different x.
double log_log_slope(const std::vector<double>& x, const std::vector<double>& y);

/// MSE times seconds: the lower, the less time an image of a given error takes.
inline double cost_of_error(const ImageError& error, double seconds) {
  return error.mse * seconds;
}

}  // namespace testbench
