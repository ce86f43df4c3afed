#pragma once

namespace path_tracer {

/// The work of a run: samples [first_sample, first_sample + samples) of every pixel.
struct Work {
  int first_sample = 0;
  int samples = 1;
};

}  // namespace path_tracer
