#pragma once

#include <cstddef>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Removes triangles that have the same three vertices in the same cyclic order as another one, because a ray
/// hits only one of them while a light is sampled for each. The first one stays, or the first one that emits.
/// The order of the others does not change. Returns the number of triangles removed.
std::size_t remove_repeated_triangles(Scene& scene);

}  // namespace testbench
