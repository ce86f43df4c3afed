#pragma once

#include "testbench/scene/scene.hpp"

namespace testbench {

/// The largest size of a coordinate of any triangle.
double largest_coordinate(const Scene& scene);

/// The scene at the origin, in a unit of length in which its largest coordinate lies in [1, 2).
///
/// Along each axis along which the triangles' box lies farther from the origin than 16 times its longest
/// side, the middle of the box is subtracted. That is exact for the vertices: a difference of two doubles,
/// neither of which is more than twice the other, is a double (Sterbenz, "Floating-Point Computation", 1974,
/// theorem 4.3.1). Cameras and lights outside that range are rounded to 2^-53 of their distance from the
/// middle. So a georeferenced model is rendered as it would be at the origin, where boxes in single precision
/// are tight.
///
/// The unit is a power of two,
/// so no digit of a coordinate changes, and what the firmware computes is the same to the bit in every unit
/// as long as no intermediate result overflows or vanishes. In this unit none does, whatever unit the
/// scene's files have. Colours and emission do not depend on the unit; emission is radiance.
Scene normalised(const Scene& scene);

}  // namespace testbench
