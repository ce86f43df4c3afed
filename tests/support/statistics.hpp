#pragma once

#include <algorithm>
#include <cmath>

/// Bounds for tests of random results. A test states the probability of a false alarm, a failure although the
/// code is right.
namespace test_support {

/// Probability of a false alarm of a whole test.
inline constexpr double kFalseAlarm = 1e-6;

/// Probability of a false alarm that each of `tests` tests may have, whatever their dependence (Bonferroni).
inline double per_test(double tests) {
  return kFalseAlarm / tests;
}

/// Returns z with P(|N(0, 1)| > z) = probability.
inline double normal_threshold(double probability) {
  double low = 0;
  double high = 40;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (std::erfc(middle / std::sqrt(2.0)) > probability ? low : high) = middle;
  }
  return high;
}

/// An upper bound of P(a count of Binomial(trials, probability) is at least as far from its mean as `count`,
/// on the same side) (Chernoff; Hoeffding 1963, theorem 1). Holds for any number of trials.
inline double binomial_tail_bound(double count, double trials, double probability) {
  const auto term = [](double a, double b) { return a > 0 ? a * std::log(a / b) : 0.0; };
  const double share = count / trials;
  return std::exp(-trials * (term(share, probability) + term(1 - share, 1 - probability)));
}

/// The largest distance of the mean of `samples` values within [low, low + range] from its expectation,
/// except with the given probability; `variance` is the sample variance (Maurer and Pontil 2009, theorem 4,
/// both sides). Holds for any distribution and any number of samples.
inline double bounded_mean_error(double variance, double samples, double range, double probability) {
  const double l = std::log(4 / probability);
  return std::sqrt(2 * variance * l / samples) + 7 * range * l / (3 * (samples - 1));
}

}  // namespace test_support
