#pragma once

#include <functional>
#include <string>
#include <vector>

#include "testbench/run/render.hpp"

/// How fast a full path tracer of the paper's scene can be on the paper's chip: from the paper's own program
/// to the fastest that this firmware has, one change after the other.
namespace testbench {

/// A change to the run before it.
struct FastestStep {
  const char* name;
  const char* change;
  void (*apply)(RenderOptions& options);
};

/// From the program of the paper's tables on. The one list: a further step is a further row.
const std::vector<FastestStep>& fastest_steps();

/// What a run measured, in cycles of the chip for each path segment.
struct FastestFigures {
  double segments_per_second = 0;
  double kernels = 0;  ///< the PE array computes
  double calls = 0;    ///< the control unit starts copies
  double waits = 0;    ///< the control unit waits for copies or the host
  double pio = 0;      ///< the PIO engine is busy, beside all that
  double others = 0;   ///< the control unit's own instructions, data cache and semaphores
};

/// The figures of all steps, in their order; each runs in a process of its own, `at_once` at a time.
/// @param base the program, chip, timing and samples of the first step
/// @param done called with the share of finished runs
std::vector<FastestFigures> measure_fastest(const Scene& scene, const RenderOptions& base, int at_once,
                                            const std::function<void(double share)>& done = {});

/// How far the images of the first and the last step are apart. Both trace the same paths.
struct ImageDistance {
  double largest_difference = 0;  ///< between two pixels' channels, over the brightest of all
  bool has_equal_counts = false;  ///< of segments and shadow rays
};
ImageDistance compare_first_and_last(const Scene& scene, const RenderOptions& base);

}  // namespace testbench
