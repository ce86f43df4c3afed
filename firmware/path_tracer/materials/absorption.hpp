#pragma once

#include <algorithm>
#include <cmath>

#include "firmware/path_tracer/materials/material.hpp"

/// Absorption within a medium (Beer and Lambert).
namespace path_tracer {

/// Absorption coefficient of a medium that turns white light into `color` over `distance`
/// (KHR_materials_volume), per unit of length. A colour of 0 absorbs as much as 1e-30 would. An infinite
/// distance absorbs nothing.
inline vec3<double> absorption_coefficient(const vec3<double>& color, double distance) {
  constexpr double kLeastColor = 1e-30;
  const auto of = [&](double channel) { return -std::log(std::max(channel, kLeastColor)) / distance; };
  return {of(color.x), of(color.y), of(color.z)};
}

/// The share of light that gets through, by colour.
/// @param absorption per unit of length
inline Rgb transmittance(const Rgb& absorption, const poly<double>& distance) {
  const Rgb depth = absorption * -distance;
  return {cn::exp(depth.x), cn::exp(depth.y), cn::exp(depth.z)};
}

}  // namespace path_tracer
