#pragma once

#include <cstddef>
#include <vector>

#include "firmware/path_tracer/records/records.hpp"

namespace testbench {

/// How likely each light is chosen. Up to kMostSingleLights lights have probabilities of their own, one for
/// each entry of the cdf. More lights are sorted into classes of lights that are equally likely; the cdf is
/// that of the classes, so that a choice costs the same however many lights there are.
struct LightChoice {
  std::vector<std::size_t> order;                ///< lights by class, the likeliest class first
  std::vector<double> cdf;                       ///< entry i: probability of lights or classes 0..i
  std::vector<path_tracer::LightClass> classes;  ///< of lights in that order; none for a few lights
  std::vector<double> probability;               ///< of each light in that order
};

inline constexpr std::size_t kMostSingleLights = 8;

/// Chooses lights in proportion to weights; where there are classes, within a factor of 2, and lights below
/// 2^-15 of the largest weight share a class.
/// @param weights positive, one for each light
LightChoice choose_by(const std::vector<double>& weights);

}  // namespace testbench
