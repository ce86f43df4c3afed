#pragma once

#include "testbench/sampling/sample_plan.hpp"

namespace testbench {

/// Adaptive sampling: passes of one shape until each pixel has kFirstSamples, then passes whose samples go
/// where they lower the picture's relative RMSE (error_estimate.hpp) most, until it is at most `target`.
///
/// The error of n samples is smallest, of all distributions of as many paths, where n is proportional to the
/// deviation of a sample (Neyman, J. R. Stat. Soc. 97, 1934). What splats add to the error depends on the
/// number of all paths only, so that does not change with them. A pass at most doubles the number of paths,
/// as the deviations are estimates that get better.
class AdaptivePlan : public SamplePlan {
 public:
  /// @param samples times a pixel's importance are the most that it gets
  AdaptivePlan(std::vector<double> importance, int samples, double target);
  std::optional<MeanSamples> next(const MeanSamples& done, const Film& film) override;

  /// None before the first passes are over.
  std::optional<double> error() const override { return error_; }

  static constexpr int kFirstSamples = 8;

 private:
  std::vector<double> importance_;
  int samples_;
  double target_;
  ShapedPlan first_passes_;
  std::optional<double> error_;
};

}  // namespace testbench
