#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace test_support {

/// A chi-square test: counts of samples in bins with known probabilities.
class ChiSquare {
 public:
  explicit ChiSquare(std::vector<double> probabilities)
      : probabilities_(std::move(probabilities)), counts_(probabilities_.size()) {}
  static ChiSquare uniform(std::size_t bins) {
    return ChiSquare(std::vector<double>(bins, 1.0 / static_cast<double>(bins)));
  }

  void add(std::size_t bin) { ++counts_.at(bin), ++samples_; }

  /// The statistic as a number of standard deviations from its mean (Wilson and Hilferty 1931). Above 4, the
  /// samples do not have this distribution; below -4, they are not random.
  double deviation() const {
    double statistic = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      const double expected = probabilities_[i] * static_cast<double>(samples_);
      const double difference = static_cast<double>(counts_[i]) - expected;
      statistic += difference * difference / expected;
    }
    const double degrees = static_cast<double>(counts_.size() - 1);
    const double variance = 2.0 / (9.0 * degrees);
    return (std::cbrt(statistic / degrees) - (1.0 - variance)) / std::sqrt(variance);
  }

 private:
  std::vector<double> probabilities_;
  std::vector<std::size_t> counts_;
  std::size_t samples_ = 0;
};

}  // namespace test_support
