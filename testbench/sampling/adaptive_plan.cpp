#include "testbench/sampling/adaptive_plan.hpp"

#include <algorithm>
#include <cmath>

#include "testbench/sampling/error_estimate.hpp"

namespace testbench {
namespace {

constexpr double kMostGrowth = 2.0;    ///< of the number of paths in a pass
constexpr double kLeastGrowth = 1.05;  ///< so that the last passes are not many small ones

/// Samples in proportion to the deviations, within what is done and what is allowed.
class Allocation {
 public:
  Allocation(const SampleDeviations& deviations, const std::vector<double>& importance, int samples,
             const MeanSamples& done)
      : deviations_(deviations), importance_(importance), samples_(samples), done_(done) {}

  /// @param scale samples per deviation
  MeanSamples at(double scale) const {
    MeanSamples means(done_.size());
    for (std::size_t pixel = 0; pixel < means.size(); ++pixel) {
      const double wanted = scale * deviations_.of_sample[pixel] * std::sqrt(importance_[pixel]);
      means[pixel] = std::max(done_[pixel], std::min(wanted, importance_[pixel] * samples_));
    }
    return means;
  }
  double error(const MeanSamples& means) const { return picture_error(deviations_, importance_, means); }
  double least_scale() const { return 1e-9 * samples_; }
  double most_scale() const {
    const double largest = *std::max_element(deviations_.of_sample.begin(), deviations_.of_sample.end());
    return largest > 0 ? 1e9 * samples_ / largest : 1;
  }

 private:
  const SampleDeviations& deviations_;
  const std::vector<double>& importance_;
  int samples_;
  const MeanSamples& done_;
};

/// The smallest scale at which `is_enough` is true, which it is from some scale on, if it ever is.
template <class IsEnough>
double smallest_scale(const Allocation& allocation, IsEnough&& is_enough) {
  constexpr int kHalvings = 64;
  double low = std::log(allocation.least_scale());
  double high = std::log(allocation.most_scale());
  for (int step = 0; step < kHalvings; ++step) {
    const double middle = (low + high) / 2;
    (is_enough(allocation.at(std::exp(middle))) ? high : low) = middle;
  }
  return std::exp(high);
}

}  // namespace

AdaptivePlan::AdaptivePlan(std::vector<double> importance, int samples, double target)
    : importance_(std::move(importance)),
      samples_(samples),
      target_(target),
      first_passes_(importance_, std::min(samples, kFirstSamples)) {}

std::optional<MeanSamples> AdaptivePlan::next(const MeanSamples& done, const Film& film) {
  if (std::optional<MeanSamples> first = first_passes_.next(done)) return first;
  const SampleDeviations deviations = sample_deviations(film);
  error_ = picture_error(deviations, importance_, done);
  if (*error_ <= target_) return std::nullopt;
  const Allocation allocation(deviations, importance_, samples_, done);
  const double paths = total(done);
  const double reaches = smallest_scale(
      allocation, [&](const MeanSamples& means) { return allocation.error(means) <= target_; });
  const double least = smallest_scale(
      allocation, [&](const MeanSamples& means) { return total(means) >= kLeastGrowth * paths; });
  const double most = smallest_scale(
      allocation, [&](const MeanSamples& means) { return total(means) >= kMostGrowth * paths; });
  MeanSamples means = allocation.at(std::clamp(reaches, least, most));
  if (total(means) - paths < 1) return std::nullopt;  // every pixel has all that it may get
  return means;
}

}  // namespace testbench
