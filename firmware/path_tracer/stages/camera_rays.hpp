#pragma once

#include <algorithm>
#include <cstdint>

#include "firmware/path_tracer/program/work.hpp"

namespace path_tracer {

/// The camera rays still to be issued: sample by sample, and pixel by pixel within a sample; or those of a
/// list, in its order.
class CameraRays {
 public:
  CameraRays(const Work& work, int pixels);

  std::int32_t next_pixel() const { return static_cast<std::int32_t>(next_ % std::uint64_t(pixels_)); }
  std::int32_t next_sample() const {
    return first_sample_ + static_cast<std::int32_t>(next_ / std::uint64_t(pixels_));
  }
  std::uint64_t remaining() const { return next_ < total_ ? total_ - next_ : 0; }
  int pixels() const { return pixels_; }
  void issue(std::uint64_t count) { next_ += count; }
  std::uint64_t issued() const { return next_; }
  /// No further path begins, but for those that a pass under way has promised its slots (stream execution).
  void stop() { total_ = std::min(total_, next_); }

 private:
  std::uint64_t next_ = 0;
  std::uint64_t total_;
  std::int32_t first_sample_;
  int pixels_;
};

/// Throws ProgramError for a stride that does not reach every pixel (ProgramConfig::pixel_stride).
void require_pixel_stride(int stride, int pixels);

}  // namespace path_tracer
