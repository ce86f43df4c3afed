#pragma once

#include <vector>

#include "testbench/paper/calibration.hpp"

namespace testbench {

/// Returns `base`, then one set of assumptions for each point that the paper leaves open, with all other
/// points as in `base`: clock, chips, primitives, an open or closed box, roulette, length of the bins, shadow
/// rays, PIO arbitration, and a fit without the cost of a call.
std::vector<Assumptions> paper_alternatives(const Assumptions& base, const Scene& closed_box);

/// The scene with every triangle cut into four of the same shape.
Scene with_four_times_the_triangles(const Scene& scene);

}  // namespace testbench
