#include "testbench/sampling/sample_plan.hpp"

#include <algorithm>
#include <cmath>

namespace testbench {

ShapedPlan::ShapedPlan(std::vector<double> importance, int samples)
    : importance_(std::move(importance)),
      samples_(samples),
      most_important_(
          std::size_t(std::max_element(importance_.begin(), importance_.end()) - importance_.begin())) {}

std::optional<MeanSamples> ShapedPlan::next(const MeanSamples& done, const Film& /*film*/) {
  return next(done);
}

std::optional<MeanSamples> ShapedPlan::next(const MeanSamples& done) const {
  const double samples = done[most_important_] / importance_[most_important_];
  if (samples >= samples_) return std::nullopt;
  double wanted = samples == 0 ? 1 : 2 * samples;
  if (wanted > 1) wanted = std::floor(wanted);  // whole passes need no list
  wanted = std::min(wanted, double(samples_));
  MeanSamples means(importance_.size());
  for (std::size_t pixel = 0; pixel < means.size(); ++pixel)
    means[pixel] = std::max(done[pixel], importance_[pixel] * wanted);
  return means;
}

}  // namespace testbench
