#include "testbench/mono_image/light_choice.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace testbench {
namespace {

/// Lights less likely than 2^-15 of the likeliest share the last class.
constexpr int kMostClasses = 16;

double total_of(const std::vector<double>& weights) {
  double total = 0;
  for (const double weight : weights) total += weight;
  return total;
}

LightChoice choose_single(const std::vector<double>& weights) {
  LightChoice choice;
  choice.order.resize(weights.size());
  std::iota(choice.order.begin(), choice.order.end(), std::size_t{0});
  const double total = total_of(weights);
  double so_far = 0;
  for (const double weight : weights) {
    so_far += weight;
    choice.cdf.push_back(so_far / total);
    choice.probability.push_back(weight / total);
  }
  return choice;
}

/// Each class spans a factor of 2, from the largest weight down.
std::vector<int> classes_of(const std::vector<double>& weights) {
  const double largest = *std::max_element(weights.begin(), weights.end());
  std::vector<int> classes;
  classes.reserve(weights.size());
  for (const double weight : weights)
    classes.push_back(std::min(std::ilogb(largest / weight), kMostClasses - 1));
  return classes;
}

LightChoice choose_by_class(const std::vector<double>& weights) {
  const std::vector<int> classes = classes_of(weights);
  const double total = total_of(weights);
  LightChoice choice;
  double so_far = 0;
  for (int number = 0; number < kMostClasses; ++number) {
    const std::size_t first = choice.order.size();
    double weight = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (classes[i] != number) continue;
      choice.order.push_back(i);
      weight += weights[i];
    }
    const std::size_t count = choice.order.size() - first;
    if (count == 0) continue;
    const double before = choice.cdf.empty() ? 0.0 : choice.cdf.back();
    so_far += weight;
    const bool is_last = choice.order.size() == weights.size();
    choice.cdf.push_back(is_last ? 1.0 : so_far / total);
    choice.classes.push_back({static_cast<std::int32_t>(first), static_cast<std::int32_t>(count)});
    choice.probability.resize(choice.order.size(), (choice.cdf.back() - before) / double(count));
  }
  return choice;
}

}  // namespace

LightChoice choose_by(const std::vector<double>& weights) {
  if (weights.size() <= kMostSingleLights) return choose_single(weights);
  return choose_by_class(weights);
}

}  // namespace testbench
