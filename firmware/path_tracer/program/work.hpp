#pragma once

#include <cstdint>

namespace path_tracer {

/// The work of a run: samples [first_sample, first_sample + samples) of every pixel, or those of a list.
struct Work {
  int first_sample = 0;
  int samples = 1;
  std::uint64_t listed_samples = 0;  ///< entries of Layout::camera_samples; 0: no list
};

}  // namespace path_tracer
