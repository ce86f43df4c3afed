#pragma once

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The largest size of a coordinate of any triangle.
double largest_coordinate(const Scene& scene);

/// The scene in a unit of length in which its largest coordinate lies in [1, 2). The unit is a power of two,
/// so no digit of a coordinate changes, and what the firmware computes is the same to the bit in every unit
/// as long as no intermediate result overflows or vanishes. In this unit none does, whatever unit the
/// scene's files have. Colours and emission do not depend on the unit; emission is radiance.
Scene normalised(const Scene& scene);

}  // namespace testbench
