#pragma once

#include <optional>
#include <vector>

#include "testbench/film/film.hpp"
#include "testbench/film/image_file.hpp"

namespace testbench {

/// Error of an image against a reference: means over the channels of all pixels that count.
struct ImageError {
  double mse = 0;                   ///< mean squared error of linear radiance
  double relative_mse = 0;          ///< squared difference / (squared reference + kRelativeOffset)
  double flip = 0;                  ///< FLIP of what a PNG shows of the two (film/flip.hpp)
  double mean_bias[3] = {0, 0, 0};  ///< for R, G and B: (mean of the image / mean of the reference) - 1; NaN
                                    ///< where the reference is black

  /// Bounds the weight of dark pixels (Rousselle, Knaus, Zwicker, SIGGRAPH Asia 2011).
  static constexpr double kRelativeOffset = 1e-2;
};

/// Error of mean radiance (three values a pixel) against a reference of the same size. The reference's
/// samples are independent, so its noise adds its stored variance to the squared difference; that variance is
/// subtracted, but not from FLIP. An error smaller than the scatter of this noise may come out negative.
/// `counts` has one entry per pixel and says whether the pixel counts; at least one must.
ImageError image_error(const std::vector<double>& rgb, const ExrFilm& reference,
                       const std::vector<bool>& counts);
ImageError image_error(const Film& film, const ExrFilm& reference, const std::vector<bool>& counts);

/// One point of an error curve.
struct CurvePoint {
  int samples = 0;  ///< per pixel
  ImageError error;
  double native_cpu_seconds = 0;            ///< of a native render
  std::optional<double> timed_cpu_seconds;  ///< of a render with the chip's timing
  std::optional<double> simulated_seconds;  ///< time that the chip takes
  std::optional<double> joules;             ///< energy that chip and memory take
};

/// Slope of log y over log x by least squares, over the points where both are positive; NaN with fewer than
/// two different x.
double log_log_slope(const std::vector<double>& x, const std::vector<double>& y);

/// MSE times what the image took: seconds, or joules. The lower it is, the less an image of a given error
/// takes.
inline double cost_of_error(const ImageError& error, double taken) {
  return error.mse * taken;
}

}  // namespace testbench
