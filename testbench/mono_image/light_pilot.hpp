#pragma once

#include <vector>

#include "testbench/mono_image/emitter.hpp"

namespace testbench {

/// Weights to choose lights by: a mixture of what each light is seen to do in a few thousand paths of the
/// host, its power, and equal parts. No light is less likely than 1/16 of what its power gives it, whatever
/// the paths missed. Where all lights lie in one face, where there is one light, or where the paths find no
/// light at all, weights are the lights' powers.
///
/// The paths are a function of the scene alone: of no chip, number of rays or ranks.
std::vector<double> light_weights(const Scene& scene, const std::vector<Emitter>& emitters);

}  // namespace testbench
