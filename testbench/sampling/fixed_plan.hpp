#pragma once

#include <vector>

#include "testbench/sampling/sample_plan.hpp"

namespace testbench {

/// Passes that end at fixed places, which neither a clock nor the picture moves, so that a render can stop
/// behind any of them and go on later to the same bits. A pass is a whole number of samples of every pixel,
/// or where one sample of all is too long, one sample of a range of pixels.
class FixedPlan : public SamplePlan {
 public:
  /// Of most renders; about a second of one core.
  static constexpr double kPathsAPass = 1 << 20;
  /// Of longer renders the passes are longer, since each adds its statistics to the run's.
  static constexpr double kMostPasses = 4096;

  /// @param importance of each pixel; times `samples` it is the number of the pixel's paths
  FixedPlan(std::vector<double> importance, int samples, double paths_a_pass = kPathsAPass);

  std::optional<MeanSamples> next(const MeanSamples& done, const Film& film) override;

 private:
  MeanSamples after(std::size_t pass) const;

  std::vector<double> importance_;
  double samples_;
  double samples_a_pass_;
  std::size_t ranges_;  ///< of pixels, one a pass
  std::size_t passes_;
  std::size_t begun_ = 0;
  MeanSamples wanted_;  ///< after the pass that was begun last
};

}  // namespace testbench
