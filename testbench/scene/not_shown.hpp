#pragma once

#include <string>

#include "testbench/scene/scene.hpp"

namespace testbench {

/// Notes what the scene has and pictures do not show, each kind once. Here and nowhere else: what the
/// firmware learns to render loses its line here.
/// @param file that the notes name
void note_what_is_not_shown(Scene& scene, const std::string& file);

}  // namespace testbench
