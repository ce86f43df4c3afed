#pragma once

#include <vector>

#include "testbench/mono_image/emitter.hpp"
#include "testbench/mono_image/light_choice.hpp"

namespace testbench {

/// What the firmware estimates each light's effect at a vertex by, in the order of `choice`.
/// @param visibility LightWeights::visibility, in the order of the emitters
/// @param radius Surroundings::radius
std::vector<path_tracer::LightCandidate> light_candidates(const std::vector<Emitter>& emitters,
                                                          const LightChoice& choice,
                                                          const std::vector<double>& visibility,
                                                          double radius);

}  // namespace testbench
