#pragma once

#include <vector>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// One entry a pixel, row by row from the top: whether the front of an emitting triangle lies in it, wholly
/// or in part, were nothing in front. Such pixels are left out of error measures: their error is that of the
/// light's edge, or none.
std::vector<bool> light_pixels(const Scene& scene);

}  // namespace testbench
