#pragma once

#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "testbench/statistics/render_report.hpp"

namespace testbench {

/// A counter of the whole render, as its parts tell.
struct EstimatedCounter {
  std::string key;  ///< in the statistics file
  double value;
  double half_width;  ///< of the interval that holds the whole render's with a probability of 95 %
};

struct Estimate {
  int samples = 0;           ///< paths a pixel of the whole render
  int samples_rendered = 0;  ///< by the parts together
  int batches = 0;           ///< 0: the whole render was run, and nothing is estimated
  int samples_of_a_batch = 0;
  std::vector<EstimatedCounter> counters;

  const EstimatedCounter& counter(const std::string& key) const;
  /// Of the simulated time's interval, over the time.
  double relative_half_width() const;
};

struct EstimateOptions {
  double within = 0.005;  ///< relative half width of the simulated time's interval to stop at
  int jobs = 1;           ///< processes at a time
};

/// Estimates the render of `request.options.work.samples` paths a pixel from batches of a few each.
///
/// A render takes a time for filling and draining its bins, and so much a sample: T = a + b samples. With the
/// same paths rendered as one batch and as its two halves, a = half + half - batch, in which the paths' own
/// variance cancels; b follows from the mean of the batches. The same holds of every counter. The half width
/// is Student's t (97.5 %) times the root of the variances of: the mean of the batches, scaled to the whole
/// render; a; and what the whole render's own paths add. Batches are doubled in number until the time's
/// interval is narrow enough. A render for which that would take more than half of its samples is run as a
/// whole.
/// @param progress takes the number of parts that are done
/// Throws as render_on_chip() does.
Estimate estimate_render(const Scene& scene, const RenderRequest& request, const EstimateOptions& options,
                         const std::function<void(int parts)>& progress);

/// Counters of the whole render, run in full.
Estimate render_in_full(const Scene& scene, const RenderRequest& request);

}  // namespace testbench
