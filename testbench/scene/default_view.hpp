#pragma once

#include "testbench/scene/scene.hpp"

namespace testbench {

/// A camera that sees the whole scene, for mesh files without one: from the front (+z), a little from the
/// right and above (+y is up), with a vertical field of view of 40 degrees on a square film.
Camera framing_camera(const Scene& scene);

/// Whether the scene has light: a triangle that emits, an environment or a light without area.
bool has_light(const Scene& scene);

/// Adds a light for scenes that have none: a square, 26 degrees above the line from the scene's centre to the
/// camera and behind the camera. It faces the centre, and a white surface there that faces the light has the
/// radiance 1.
void add_default_light(Scene& scene);

}  // namespace testbench
