#pragma once

#include <vector>

#include "testbench/mono_image/emitter.hpp"

namespace testbench {

/// What a few thousand paths of the host say about each light.
struct LightWeights {
  /// To choose lights by: a mixture of what each light is seen to do, its power, and equal parts. No light is
  /// less likely than 1/16 of what its power gives it, whatever the paths missed. Where all lights lie in one
  /// face, where there is one light, or where the paths find no light at all, these are the lights' powers.
  std::vector<double> choice;
  /// The share of a light in `choice` over its share in what all lights would do if nothing were between: far
  /// below others' where a light is hidden. 1 for all lights where the paths say nothing.
  std::vector<double> visibility;
};

/// The paths are a function of the scene alone: of no chip, number of rays or ranks.
LightWeights light_weights(const Scene& scene, const std::vector<Emitter>& emitters);

}  // namespace testbench
