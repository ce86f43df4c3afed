#pragma once

#include "firmware/path_tracer/records/tails.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// How the normal texture of a triangle of the scene lies on it: by the tangents of its file, or by its
/// texture coordinates. Zeros, with which a texture does nothing, if it has no such texture or neither says
/// how.
path_tracer::TangentRecord tangent_record(const Scene& scene, std::size_t triangle);

/// What varies over the triangle; zeros where nothing does.
path_tracer::TangentSlopeRecord tangent_slope_record(const Scene& scene, std::size_t triangle);

/// Whether any triangle's does.
bool has_varying_tangents(const Scene& scene);

}  // namespace testbench
