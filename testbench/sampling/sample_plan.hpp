#pragma once

#include <optional>

#include "testbench/film/film.hpp"
#include "testbench/sampling/sample_counts.hpp"

namespace testbench {

/// Says, pass by pass, how many samples the pixels of a picture get.
class SamplePlan {
 public:
  SamplePlan() = default;
  virtual ~SamplePlan() = default;
  SamplePlan(const SamplePlan&) = delete;
  SamplePlan& operator=(const SamplePlan&) = delete;

  /// The samples of each pixel after the next pass, in the mean; std::nullopt when the picture is complete.
  /// @param done those before it; the pass before may have been cut short of what was planned
  /// @param film the picture so far
  virtual std::optional<MeanSamples> next(const MeanSamples& done, const Film& film) = 0;

  /// The relative RMSE of the film that the last call of next() saw, if the plan knows it.
  virtual std::optional<double> error() const { return std::nullopt; }
};

/// Passes of one shape: importance, then as much again as there is, until importance * samples.
class ShapedPlan : public SamplePlan {
 public:
  ShapedPlan(std::vector<double> importance, int samples);
  std::optional<MeanSamples> next(const MeanSamples& done, const Film& film) override;
  /// The same; the plan needs no film.
  std::optional<MeanSamples> next(const MeanSamples& done) const;

 private:
  std::vector<double> importance_;
  int samples_;
  std::size_t most_important_;
};

}  // namespace testbench
