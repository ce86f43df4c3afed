#include "testbench/sampling/fixed_plan.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace testbench {

FixedPlan::FixedPlan(std::vector<double> importance, int samples, double paths_a_pass)
    : importance_(std::move(importance)), samples_(samples) {
  const double paths_a_sample = total(importance_);
  const double paths = std::max(paths_a_pass, paths_a_sample * samples_ / kMostPasses);
  samples_a_pass_ = std::max(1.0, std::floor(paths / paths_a_sample));
  const double ranges = std::max(1.0, std::ceil(paths_a_sample / paths));
  ranges_ = std::min(std::size_t(ranges), importance_.size());
  passes_ = std::size_t(std::ceil(samples_ / samples_a_pass_)) * ranges_;
}

MeanSamples FixedPlan::after(std::size_t pass) const {
  const std::size_t passes_before = pass / ranges_;
  const double before = double(passes_before) * samples_a_pass_;
  const double behind = std::min(samples_, before + samples_a_pass_);
  const std::size_t end = importance_.size() * (pass % ranges_ + 1) / ranges_;
  MeanSamples means(importance_.size());
  for (std::size_t pixel = 0; pixel < means.size(); ++pixel)
    means[pixel] = importance_[pixel] * (pixel < end ? behind : before);
  return means;
}

/// A pass that was cut short, as mono memory has no room for a longer list, is begun again.
std::optional<MeanSamples> FixedPlan::next(const MeanSamples& done, const Film& /*film*/) {
  if (begun_ == 0 || done == wanted_) {
    if (begun_ == passes_) return std::nullopt;
    wanted_ = after(begun_++);
  }
  return wanted_;
}

}  // namespace testbench
