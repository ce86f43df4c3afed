#pragma once

#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// One entry per pixel, row by row from the top: whether the front of an emitting triangle projects to a part
/// of the pixel, occluded or not. Measures of error leave these pixels out, because their error is only that
/// of the light's edge.
std::vector<bool> light_pixels(const Scene& scene);

}  // namespace testbench
