#pragma once

#include "firmware/path_tracer/records/tails.hpp"
#include "testbench/scene/scene.hpp"

namespace testbench {

/// How the normal texture of a triangle of the scene lies on it, by its texture coordinates; zeros, with
/// which a texture does nothing, if it has no such texture or its coordinates span no area.
path_tracer::TangentRecord tangent_record(const Scene& scene, std::size_t triangle);

}  // namespace testbench
